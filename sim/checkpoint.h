// A simulation's state as bytes.
#pragma once

#include "sim/state.h"

#include <cstddef>
#include <vector>

namespace sim {

/// All that the next steps depend on.
struct Snapshot {
    State state;
    // (#bodies, #domains) of those that have such domains.
    std::vector<std::vector<char>> enriched;
};

std::vector<std::byte> write_checkpoint(const Snapshot& snapshot);

/// Whether write_checkpoint() of this version wrote it.
bool is_checkpoint(const std::vector<std::byte>& bytes);

/// What was written. Throws std::logic_error where it is not of the same bodies as `present`, a snapshot of the scene that
/// is to go on.
Snapshot read_checkpoint(const std::vector<std::byte>& bytes, const Snapshot& present);

}  // namespace sim
