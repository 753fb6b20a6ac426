// The same work on another number of threads.
#pragma once

#include <tbb/global_control.h>

namespace tests {

/// work() with at most `n` threads.
template <class Work>
auto on_threads(int n, const Work& work) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return work();
}

}  // namespace tests
