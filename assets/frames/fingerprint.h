// Whether frames on disk come from the same inputs, and what differs where they do not.
#pragma once

#include "assets/frames/frame_cache.h"

#include <string>

namespace assets {

/// "solver.dt: 0.001 -> 0.002, fps: 24 -> (absent)"; the first few keys that differ, long values shortened.
std::string differences(const Fingerprint& found, const Fingerprint& wanted);

}  // namespace assets
