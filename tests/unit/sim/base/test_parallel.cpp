#include "sim/base/parallel.h"
#include "tests/support/threads.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>

TEST_CASE("chunks cover every index once and end at multiples of their size") {
    for (const int n : {0, 1, 9, 10, 11, 1234}) {
        std::vector<std::atomic<int>> visits(n);
        std::atomic<int> misplaced = 0;
        sim::for_chunks(n, 10, [&](int begin, int end) {
            misplaced += begin % 10 != 0 || end - begin > 10 || end <= begin;
            for (int i = begin; i < end; ++i)
                ++visits[i];
        });
        CAPTURE(n);
        CHECK(misplaced == 0);
        for (const auto& count : visits)
            REQUIRE(count == 1);
    }
}

TEST_CASE("sums are added chunk by chunk, whatever the number of threads") {
    // Terms of very different size: another order of addition would round differently.
    const int n = 10007, chunk = 100;
    std::vector<double> terms(n);
    for (int i = 0; i < n; ++i)
        terms[i] = std::sin(i) * std::pow(10.0, i % 17);
    const auto part = [&](int begin, int end) {
        double sum = 0;
        for (int i = begin; i < end; ++i)
            sum += terms[i];
        return sum;
    };
    double expected = 0;
    for (int begin = 0; begin < n; begin += chunk)
        expected += part(begin, std::min(begin + chunk, n));
    for (const int threads : {1, 2}) {
        const double sum =
            tests::on_threads(threads, [&] { return sim::sum_chunks(n, chunk, part); });
        CHECK(sum == expected);
    }
    CHECK(sim::sum_chunks(0, chunk, part) == 0);
}
