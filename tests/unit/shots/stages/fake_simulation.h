// Stands in for sim::Simulation where only what surrounds it is tested: a number that grows with time, fast and exact.
// Every body of its scene is made of three points.
#pragma once

namespace tests {

/// What happened to all simulations of this process so far.
struct SimulationCounts {
    int built = 0, advanced = 0, restored = 0;
};

SimulationCounts& simulation_counts();

/// From this time on advance_to() throws Error(Diverged).   [s]
double& divergence_time();

/// At this time advance_to() sends SIGTERM to its own process.   [s]
double& interruption_time();

}  // namespace tests
