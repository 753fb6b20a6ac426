// SIGINT and SIGTERM end a stage between two frames, where everything is saved, or give up the frame that it is at.
#pragma once

namespace shots {

/// From now on the first SIGINT or SIGTERM only sets a flag; a second one ends the program at once.
void catch_interruptions();

/// Throws Error(Interrupted) where such a signal has come. Stages call it where what they have saved is whole.
void stop_if_interrupted();

}  // namespace shots
