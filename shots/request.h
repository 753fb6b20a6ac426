// From what the command line asks for to the shot at hand.
#pragma once

#include "shots/commands.h"
#include "shots/shot_file.h"

#include <functional>
#include <vector>

namespace shots {

/// The shot with the overrides and the output folder of the request; its warnings are told on stderr.
Shot requested_shot(const Request& request);

/// The frames to render: those of --frames, else of the shot. Throws Error(Input) where the shot does not have one.
std::vector<int> requested_frames(const Request& request, const Shot& shot);

/// All frames from the shot's first to `last`: a simulation cannot leave any out.
std::vector<int> frames_until(const Shot& shot, int last);

/// Does `work`; an error that names a word of the shot file gets its place in front: ShotFileError.
void with_places(const Shot& shot, const std::function<void()>& work);

}  // namespace shots
