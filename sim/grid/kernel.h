// B-spline kernels of the background grid: a node's weight is the product of one spline per axis. [SKB08 §3]
#pragma once

#include "sim/base/field.h"
#include "sim/scene.h"

#include <utility>

namespace sim {

/// Splines of order 1, 2 and 3 on nodes one cell apart; a point meets n = order + 1 of them per axis. A point's place in
/// its stencil is t, its distance from the lowest of these nodes in cells: order = 1: [0, 1), 2: [1/2, 3/2), 3: [1, 2).
/// All three axes are handled at once; the fourth entries mean nothing.
template <int order>
struct Spline {
    static constexpr int n = order + 1;

    /// How far the lowest node of a stencil lies below the whole number of cells before a point: floor(x/h - shift).
    static constexpr double shift = 0.5 * (order - 1);

    /// Second moment Σ_a w_a (a - t)², the same for all t: D of [JSS15 §5.1]. Of linear splines it is t (1 - t).
    static constexpr double second_moment = (order + 1) / 12.0;

    /// w_a(t), which sum to 1.
    static void weights(const Vec3p& t, Vec3p* w) {
        if constexpr (order == 1) {
            w[0] = 1 - t;
            w[1] = t;
        } else if constexpr (order == 2) {
            const Vec3p low = 1.5 - t, mid = t - 1, high = t - 0.5;
            w[0] = 0.5 * low * low;
            w[1] = 0.75 - mid * mid;
            w[2] = 0.5 * high * high;
        } else {
            const Vec3p f = t - 1, g = 2 - t;
            w[0] = (1.0 / 6) * g * g * g;
            w[1] = (2.0 / 3) - f * f * (1 - 0.5 * f);
            w[2] = (2.0 / 3) - g * g * (1 - 0.5 * g);
            w[3] = (1.0 / 6) * f * f * f;
        }
    }

    /// ∂w_a/∂x in 1/cells, which sum to 0: node a is at a distance a - t, so it gains what t gains.
    static void slopes(const Vec3p& t, Vec3p* slope) {
        if constexpr (order == 1) {
            slope[0] = Vec3p{} - 1;
            slope[1] = Vec3p{} + 1;
        } else if constexpr (order == 2) {
            slope[0] = t - 1.5;
            slope[1] = 2 - 2 * t;
            slope[2] = t - 0.5;
        } else {
            const Vec3p f = t - 1, g = 2 - t;
            slope[0] = -0.5 * g * g;
            slope[1] = f * (1.5 * f - 2);
            slope[2] = g * (2 - 1.5 * g);
            slope[3] = 0.5 * f * f;
        }
    }
};

/// visitor(Spline) with the spline of `kernel`: one compiled loop per kernel.
template <class Visitor>
decltype(auto) visit_spline(Kernel kernel, Visitor&& visitor) {
    switch (kernel) {
        case Kernel::Quadratic:
            return visitor(Spline<2>{});
        case Kernel::Cubic:
            return visitor(Spline<3>{});
        default:
            return visitor(Spline<1>{});
    }
}

}  // namespace sim
