// What a step changes and later steps depend on.
#pragma once

#include "sim/base/field.h"
#include "sim/contact/surface_contact.h"
#include "sim/grid/corner_map.h"
#include "sim/points/material_points.h"

#include <limits>
#include <vector>

namespace sim {

/// A grid whose nodes move along with the bodies, x_i' = v_i, and keep their velocities, as free corners do. w_ic, the weight of
/// a node at a corner, is what it was when the map was made, until pins take hold or let go; Σ_i w_ic x_i is where the
/// corner is, whatever it has gone through. The motion is the Galerkin projection of `fem` on the nodes, with mass lumped
/// there: it keeps energy, momentum and angular momentum as `fem` does. Mass lies further out than at the corners, by
/// h²/8 along each axis where cells are two domains wide: a cube three cells wide is 16% harder to turn.
///
/// [Z18] takes weights anew where corners are in a grid at rest. That drains 7 to 27% of the energy in ten swings of a bar:
/// weights that change scramble what nodes do not see, and each way between corners and nodes blunts it. Needed is such a
/// grid only where bodies meet on it; else this one is used, with the same nodes at the start.
struct MovingGrid {
    Field made_at;           // (#C) where corners were when the map was made [m]
    std::vector<char> free;  // (#C) which of them were free
    std::vector<int> held;   // corners that pins held then
    Field x, v;              // (#nodes) positions [m], velocities [m/s]
    // Where the last step began; BDF2 alone, empty where it has no such step.
    Field x_before, v_before;
};

/// Indexed by corner. All of it belongs in a checkpoint.
struct State {
    double time = 0;  // [s]
    Field x, v;       // positions [m], velocities [m/s]
    // Of insides and contacts on corners, where the last step and the one before ended [N]
    Field inner_force, inner_force_before;
    // Where the last step began; kept by BDF2 alone, empty before its first step.
    Field x_before, v_before;
    MovingGrid grid;  // empty where every step makes a map of its own, of a grid at rest
    // C = B D⁻¹ of [JSS15], how v changes around x; of APIC alone [1/s]
    std::vector<Gradient> affine;
    std::vector<PointState> points;     // (#bodies) empty for those of domains
    std::vector<double> top_speed;      // (#bodies) that any corner has reached lately [m/s]
    std::vector<HeldContact> contacts;  // that the last step ended with
    double last_dt = 0;                 // of the last step, 0 before the first [s]
    double dt_limit = std::numeric_limits<
        double>::infinity();    // what failed and unstable steps left of dt [s]
    double quiet_drifts = 1e6;  // of explicit steps since bodies last touched each other
    double drift = 0;           // of the last explicit step; 0 before the first [s]
};

}  // namespace sim
