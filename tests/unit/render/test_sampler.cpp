#include "render/pathtrace/sampler.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

using render::owen_sobol;
using render::Pair;

namespace {

// Largest number of points in any of the 2^m boxes of 2^-k by 2^-(m-k).
int fullest_box(std::uint32_t first, int m, int k, std::uint32_t seed) {
    std::vector<int> count(std::size_t(1) << m, 0);
    for (std::uint32_t i = first; i < first + (1u << m); ++i) {
        const Pair p = owen_sobol(i, seed);
        const int column = int(p.x * float(1 << k)), row = int(p.y * float(1 << (m - k)));
        ++count[std::size_t(column) << (m - k) | std::size_t(row)];
    }
    return *std::max_element(count.begin(), count.end());
}

}  // namespace

TEST_CASE("aligned blocks of the sampler are (0, m, 2)-nets") {
    for (const std::uint32_t seed : {0u, 1u, 77u, 0xdeadbeefu})
        for (int m = 0; m <= 10; ++m)
            for (int k = 0; k <= m; ++k)
                for (const std::uint32_t block : {0u, 1u, 5u}) {
                    CAPTURE(seed, m, k, block);
                    REQUIRE(fullest_box(block << m, m, k, seed) == 1);
                }
}

TEST_CASE("sequences of different seeds are uncorrelated") {
    // Mean of (x_a - 1/2)(x_b - 1/2) over n independent pairs has the standard deviation 1 / (12 √n).
    constexpr int n_seeds = 2000;
    double sum = 0;
    for (std::uint32_t seed = 0; seed < n_seeds; ++seed)
        sum += (owen_sobol(3, seed).x - 0.5) * (owen_sobol(3, seed + 1).x - 0.5);
    CHECK(std::abs(sum / n_seeds) < 4 / (12 * std::sqrt(double(n_seeds))));
}

TEST_CASE("each point of the sampler is uniform over the seeds") {
    constexpr int n_seeds = 4000;
    const double sigma = 1 / std::sqrt(12.0 * n_seeds);
    for (const std::uint32_t index : {0u, 1u, 6u}) {
        double x = 0, y = 0;
        for (std::uint32_t seed = 0; seed < n_seeds; ++seed) {
            const Pair p = owen_sobol(index, seed);
            x += p.x / n_seeds, y += p.y / n_seeds;
        }
        CHECK(std::abs(x - 0.5) < 4 * sigma);
        CHECK(std::abs(y - 0.5) < 4 * sigma);
    }
}
