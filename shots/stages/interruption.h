// SIGINT and SIGTERM end a stage between two frames, where everything is saved.
#pragma once

namespace shots {

/// From now on the first SIGINT or SIGTERM only sets a flag; a second one ends the program at once.
void catch_interruptions();

/// Throws Error(Interrupted) where such a signal has come. Stages call it between frames.
void stop_if_interrupted();

}  // namespace shots
