// Loops over fixed chunks: the chunks depend on the size alone, so every result is the same for any number of threads.
#pragma once

#include <tbb/parallel_for.h>

#include <vector>

namespace sim {

/// body(begin, end) for consecutive chunks of [0, n); a single chunk runs in the caller without any scheduling.
template <class Body>
void for_chunks(int n, int chunk, const Body& body) {
    if (n <= chunk) {
        if (n > 0)
            body(0, n);
        return;
    }
    const int n_chunks = (n + chunk - 1) / chunk;
    tbb::parallel_for(0, n_chunks, [&](int k) {
        const int begin = k * chunk;
        body(begin, begin + chunk < n ? begin + chunk : n);
    });
}

/// Σ of body(begin, end) over the chunks, numbers or vectors, added in their order.
template <class Body>
auto sum_chunks(int n, int chunk, const Body& body) {
    using Sum = decltype(body(0, 0));
    if (n <= chunk)
        return n > 0 ? body(0, n) : Sum{};
    const int n_chunks = (n + chunk - 1) / chunk;
    std::vector<Sum> parts(n_chunks);
    tbb::parallel_for(0, n_chunks, [&](int k) {
        const int begin = k * chunk;
        parts[k] = body(begin, begin + chunk < n ? begin + chunk : n);
    });
    Sum sum{};
    for (const Sum& part : parts)
        sum += part;
    return sum;
}

}  // namespace sim
