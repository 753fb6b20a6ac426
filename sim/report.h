// The numbers of a frame: what stats.csv, probes.csv and pins.csv hold.
#pragma once

#include "sim/simulation.h"
#include "sim/stepper.h"

namespace sim {

Stats stats_of(Assembly& assembly, Stepper& stepper, const State& state);

std::vector<ProbeRow> probes_of(const Scene& scene,
                                const Assembly& assembly,
                                const State& state);

std::vector<PinRow> pins_of(const Scene& scene,
                            const Assembly& assembly,
                            const Stepper& stepper,
                            const State& state);

/// Largest principal stretch of each point, of snow its elastic part.   (#P)
std::vector<float> stretches(const PointState& state);

/// Positions of the corners, or points, of one body.   (#C of the body) [m]
std::vector<Vec3> corners_of(const AssembledBody& body, const Field& x);

}  // namespace sim
