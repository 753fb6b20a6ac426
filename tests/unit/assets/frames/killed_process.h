// Kills a process at every moment that matters: before each operation that changes files, and in the midst of writes.
#pragma once

#include <functional>

namespace tests {

/// Runs `work` in another process that is killed (SIGKILL) at its operation number `n_operations` on files, from 0.
/// Returns whether it was; false where `work` had ended before. Throws where it ended in any other way.
bool killed_at_file_operation(const std::function<void()>& work, int n_operations);

}  // namespace tests
