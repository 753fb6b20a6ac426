// How pins hold bodies of points: by nodes of their grid.
#pragma once

#include "sim/assembly.h"
#include "sim/grid/corner_map.h"
#include "sim/pinning.h"

#include <vector>

namespace sim {

/// A node that pins hold in a step.
struct PinnedNode {
    int dof = 0;
    HeldBy holder = held_by_none;
    Vec3p is_free{};   // 0 in held components
    Vec3p velocity{};  // in these [m/s]
};

/// A pin moves the nodes more than half of whose mass comes from its points, or, where there is none, those with the largest
/// share of it: the clamped face is where a pin of corners has it, give or take half a cell. A node goes where the pin's
/// rigid motion takes its place during the step (x_n -> over dt), and kernels reproduce that, so points among held nodes
/// move exactly and unstrained. Later pins win, axis by axis. `mass_on_dofs` = Tᵀ m (#dofs) [kg].
std::vector<PinnedNode> pinned_nodes(const Scene& scene,
                                     const Assembly& assembly,
                                     const CornerMap& map,
                                     const std::vector<double>& mass_on_dofs,
                                     double time,
                                     double dt);

}  // namespace sim
