#include "sim/pinned_nodes.h"

#include <algorithm>

namespace sim {

namespace {

constexpr double enough = 0.5;               // of a node's mass
constexpr double share_rounding = 1 - 1e-9;  // equal shares, but for rounding
constexpr double instant = 1e-6;  // [s] in which a pin's velocity is seen where dt is 0

}  // namespace

std::vector<PinnedNode> pinned_nodes(const Scene& scene,
                                     const Assembly& assembly,
                                     const CornerMap& map,
                                     const std::vector<double>& mass_on_dofs,
                                     double time,
                                     double dt) {
    std::vector<PinnedNode> result;
    std::vector<int> entry_of_dof;
    Field held_mass, on_dofs(map.n_dofs());
    for (std::size_t k = 0; k < scene.pins.size(); ++k) {
        const Pin& pin = scene.pins[k];
        const std::vector<int>& points = assembly.pins[k].points;
        if (points.empty() || !is_in_force(pin, time))
            continue;
        held_mass.assign(assembly.n_corners(), Vec3p{});
        for (const int c : points)
            held_mass[c] = assembly.mass[c];
        map.apply_transposed(held_mass, on_dofs);
        const auto share = [&](int i) {
            return mass_on_dofs[i] > 0 ? on_dofs[i][0] / mass_on_dofs[i] : 0;
        };
        double largest = 0;
        for (int i = 0; i < map.n_dofs(); ++i)
            largest = std::max(largest, share(i));

        entry_of_dof.resize(map.n_dofs(), -1);
        const double length = dt > 0 ? dt : instant;
        const double moves = std::min(length, pin.until - time);
        for (int i = 0; i < map.n_dofs(); ++i) {
            if (!(share(i) >= share_rounding * std::min(enough, largest)))
                continue;
            if (entry_of_dof[i] < 0) {
                entry_of_dof[i] = static_cast<int>(result.size());
                result.push_back({i, held_by_none, Vec3p{1, 1, 1, 0}, Vec3p{}});
            }
            PinnedNode& node = result[entry_of_dof[i]];
            const Vec3 at = unpadded(map.dof_position()[i]);
            const Vec3 velocity = (pinned_position(pin, at, moves) - at) / length;
            for (int axis = 0; axis < 3; ++axis)
                if (pin.only[axis]) {
                    node.is_free[axis] = 0;
                    node.velocity[axis] = velocity[axis];
                    node.holder[axis] = static_cast<int>(k);
                }
        }
    }
    return result;
}

}  // namespace sim
