// Held columns, whose corners strain frees and slaves.
#pragma once

#include "tests/support/soft_block.h"

#include <algorithm>
#include <string>

namespace tests {

/// n columns of domains of edge 0.1 m and 1e5 Pa, 0.8 m high, their feet held, each with a probe at its top. The first is
/// thrown down so fast that domains are squashed to less than half, become enriched, and recover; the others swing.
inline sim::Scene squashed_columns(int n, sim::Steps steps) {
    sim::Scene scene;
    for (int k = 0; k < n; ++k) {
        const std::string name = "column" + std::to_string(k);
        const Vec3 low(3.0 * k, 0, 0);
        scene.bodies.push_back(soft_block(name.c_str(), low, {0.2, 0.2, 0.8}, 0.1, 1e5));
        scene.bodies[k].velocity = k == 0 ? Vec3(0, 0, -8) : Vec3(2, 0, 0);
        scene.pins.push_back(foot_of(name.c_str()));
        scene.probes.push_back({"top", name, low + Vec3(0.1, 0.1, 0.8)});
    }
    scene.solver.method = sim::Method::Enriched;
    scene.solver.enrich = {false, false, false, true};
    scene.solver.steps = steps;
    scene.solver.dt = 1e-3;
    return scene;
}

/// How many vertices of the first body's surface belong to enriched domains; none where its method has none.
inline int n_enriched(const sim::Simulation& simulation) {
    const assets::SurfaceFrame surface = simulation.deformed_surfaces().front();
    const auto flags = surface.attributes.find("enriched");
    if (flags == surface.attributes.end())
        return 0;
    return static_cast<int>(std::count_if(
        flags->second.begin(), flags->second.end(), [](float flag) { return flag > 0; }));
}

}  // namespace tests
