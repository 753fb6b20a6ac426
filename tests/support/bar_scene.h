// The three-segment cantilever of the paper's figure 13 and of the reference problem C1.
#pragma once

#include "sim/scene.h"

namespace tests {

struct BarOptions {
    std::array<int, 3> n_domains{19, 7, 7};
    double domain_size = 0.025;                      // [m]
    std::array<int, 2> segment_ends{6, 13};          // in domains along x
    double end_modulus = 1e6, middle_modulus = 1e5;  // [Pa]
    sim::Model model = sim::Model::NeoHookean;
    sim::SolverOptions solver;
    sim::Contact::Mode contact = sim::Contact::Mode::Surface;
};

/// Clamped at x = 0, gravity 10 m/s² along -z, a probe "tip" at the centre of the end face.
sim::Scene bar_scene(const BarOptions& options);

}  // namespace tests
