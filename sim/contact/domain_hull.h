// Domains from outside: how far a point is from them at least.
#pragma once

#include "sim/contact/padded_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sim {

/// Axes, and diagonals of the faces and of the cube: 13 unit vectors, four side by side; the last stands for the rest.
struct HullDirections {
    static constexpr int n = 13, n_fours = (n + 3) / 4;
    std::array<Vec3p, n_fours> x{}, y{}, z{};

    HullDirections() {
        for (int k = 0; k < 4 * n_fours; ++k) {
            // One half of the 26 neighbours of a cell.
            const int code = std::min(k, n - 1) + 14;
            const Vec3 unit = Vec3(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1).normalized();
            x[k / 4][k % 4] = unit.x();
            y[k / 4][k % 4] = unit.y();
            z[k / 4][k % 4] = unit.z();
        }
    }

    /// Of a point in the directions of four k.   [m]
    Vec3p along(int four, const Vec3p& at) const {
        return x[four] * at[0] + y[four] * at[1] + z[four] * at[2];
    }
};

inline const HullDirections hull_directions;

/// From what a trilinear map gives at the corners of a cube to what it gives `share` of an edge beyond them.
inline void go_beyond(double share, std::array<Vec3p, 8>& corners) {
#pragma GCC unroll 3
    for (int axis = 1; axis < 8; axis *= 2)
#pragma GCC unroll 8
        for (int a = 0; a < 8; ++a)
            if (!(a & axis)) {
                const Vec3p beyond = share * (corners[a | axis] - corners[a]);
                corners[a] -= beyond;
                corners[a | axis] += beyond;
            }
}

/// Around the mean of a domain's corners, so large that it holds them: all that the trilinear map gives between them, too.
struct Ball {
    Vec3p centre{};             // [m]
    double squared_radius = 0;  // [m²]

    explicit Ball(const std::array<Vec3p, 8>& corners) {
        for (const Vec3p& x : corners)
            centre += 0.125 * x;
        for (const Vec3p& x : corners)
            squared_radius = std::max(squared_radius, dot(x - centre, x - centre));
    }

    bool holds(const Vec3p& x) const { return dot(x - centre, x - centre) <= squared_radius; }
};

/// A domain from outside: its extent in each direction, and a ball.
struct Hull {
    Ball ball;
    std::array<Vec3p, HullDirections::n_fours> low, high;

    explicit Hull(const std::array<Vec3p, 8>& corners) : ball(corners) {
        for (int k = 0; k < HullDirections::n_fours; ++k) {
            low[k] = high[k] = hull_directions.along(k, corners[0]);
            for (int a = 1; a < 8; ++a) {
                const Vec3p along = hull_directions.along(k, corners[a]);
                low[k] = smaller(low[k], along);
                high[k] = larger(high[k], along);
            }
        }
    }

    /// Of x, along the direction that parts it most; changes by no more than x moves, seen from the corners.   [m]
    double gap(const Vec3p& x) const {
        Vec3p most = Vec3p{} - std::numeric_limits<double>::infinity();
        for (int k = 0; k < HullDirections::n_fours; ++k) {
            const Vec3p along = hull_directions.along(k, x);
            most = larger(most, larger(along - high[k], low[k] - along));
        }
        return std::max(largest_entry(most), most[3]);
    }

    /// Whether neither the ball nor any direction parts them.
    bool holds(const Vec3p& x) const { return gap(x) <= 0 && ball.holds(x); }
};

}  // namespace sim
