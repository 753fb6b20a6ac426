// Motion that another program has baked frame by frame: .chan files.
#pragma once

#include "sim/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace shots {

/// Keys from a .chan file as Houdini, Nuke and Blender write them: on each line a frame, tx ty tz [m], rx ry rz [degrees],
/// turned about x first, then y, then z, and perhaps a field of view, which is nothing to us; '#' begins a remark. Angles
/// go the shorter way from frame to frame, as writers wrap them at half a turn. `first_frame` is at time 0.
///
/// What is wrong goes into `mistakes` as "line:column: ...", all in one pass. Throws assets::Error(Input) where the file cannot
/// be read.
std::vector<sim::ColliderKey> read_motion(const std::filesystem::path& file,
                                          int first_frame,
                                          double fps,
                                          std::vector<std::string>& mistakes);

}  // namespace shots
