// Domains from outside: how far a point is from them at least.
#pragma once

#include "sim/contact/padded_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sim {

constexpr int n_hull_directions = 13;

/// Axes, and diagonals of the faces and of the cube.
inline const std::array<Vec3p, n_hull_directions> hull_directions = [] {
    std::array<Vec3p, n_hull_directions> made;
    for (int n = 0; n < n_hull_directions; ++n) {
        const int code = n + 14;  // one half of the 26 neighbours of a cell
        made[n] = padded(Vec3(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1).normalized());
    }
    return made;
}();

constexpr double beyond_domain = 0.25;  // of domains beyond themselves, in domain edges

/// From what a trilinear map gives at the corners of a cube to what it gives a quarter beyond them.
inline void go_beyond(std::array<Vec3p, 8>& corners) {
#pragma GCC unroll 3
    for (int axis = 1; axis < 8; axis *= 2)
#pragma GCC unroll 8
        for (int a = 0; a < 8; ++a)
            if (!(a & axis)) {
                const Vec3p beyond = beyond_domain * (corners[a | axis] - corners[a]);
                corners[a] -= beyond;
                corners[a | axis] += beyond;
            }
}

/// A continued domain from outside: its extent in each direction, and a ball.
struct Hull {
    Vec3p centre{};
    double squared_radius = 0;
    std::array<double, n_hull_directions> low, high;

    explicit Hull(const std::array<Vec3p, 8>& corners) {
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-low[0]);
        for (const Vec3p& x : corners) {
            centre += 0.125 * x;
            for (int k = 0; k < n_hull_directions; ++k) {
                const double along = dot(hull_directions[k], x);
                low[k] = std::min(low[k], along);
                high[k] = std::max(high[k], along);
            }
        }
        for (const Vec3p& x : corners)
            squared_radius = std::max(squared_radius, dot(x - centre, x - centre));
    }

    /// Of x, along the direction that parts it most; changes by no more than x moves, seen from the corners.   [m]
    double gap(const Vec3p& x) const {
        double most = -std::numeric_limits<double>::infinity();
        for (int k = 0; k < n_hull_directions; ++k) {
            const double along = dot(hull_directions[k], x);
            most = std::max({most, along - high[k], low[k] - along});
        }
        return most;
    }

    /// Whether neither the ball nor any direction parts them.
    bool holds(const Vec3p& x) const {
        return gap(x) <= 0 && dot(x - centre, x - centre) <= squared_radius;
    }
};

}  // namespace sim
