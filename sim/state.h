// What a step changes and later steps depend on.
#pragma once

#include "sim/base/field.h"
#include "sim/contact/surface_contact.h"
#include "sim/grid/corner_map.h"
#include "sim/points/material_points.h"

#include <limits>
#include <vector>

namespace sim {

/// Indexed by corner. All of it belongs in a checkpoint.
struct State {
    double time = 0;  // [s]
    Field x, v;       // positions [m], velocities [m/s]
    Field inner_force,
        inner_force_before;  // of insides and contacts on corners, where the last step and the one before ended [N]
    Field x_before,
        v_before;  // where the last step began; kept by BDF2 alone, empty before its first step
    std::vector<Gradient> affine;  // C = B D⁻¹ of [JSS15], how v changes around x; of APIC alone [1/s]
    std::vector<PointState> points;     // (#bodies) empty for those of domains
    std::vector<double> top_speed;      // (#bodies) that any corner has reached lately [m/s]
    std::vector<HeldContact> contacts;  // that the last step ended with
    double last_dt = 0;                 // of the last step, 0 before the first [s]
    double dt_limit = std::numeric_limits<
        double>::infinity();    // what failed and unstable steps left of dt [s]
    double quiet_drifts = 1e6;  // of explicit steps since bodies last touched each other
};

}  // namespace sim
