// Prescribed motion of corners over a step.
#pragma once

#include "sim/assembly.h"

#include <array>
#include <vector>

namespace sim {

/// The pin that holds each component of a corner or a node, -1 where none does.
using HeldBy = std::array<int, 3>;
inline constexpr HeldBy held_by_none = {-1, -1, -1};

/// Which components are prescribed at a step, where they go, and which pin holds them.
struct Prescribed {
    Field is_free;  // (#C) 1 in free components, 0 in prescribed ones
    Field target;   // (#C) position at the end of the step in prescribed components [m]
    std::vector<HeldBy> holder;  // (#C)
    std::vector<int> corners;    // those with a prescribed component, in order
};

/// Whether a pin has not been released by `time`.
bool is_in_force(const Pin& pin, double time);

/// Where the pin moves a corner to by `time`: X, X + v t, or X turned about the axis by rate·t.   [m]
Vec3 pinned_position(const Pin& pin, const Vec3& X, double time);

/// Sets `prescribed` to the pins in force during (time_begin, time_end]; it is empty at first, else of an earlier call.
/// A pin is released after `until`; later pins win, axis by axis.
void prescribe(const Scene& scene,
               const Assembly& assembly,
               double time_begin,
               double time_end,
               Prescribed& prescribed);

}  // namespace sim
