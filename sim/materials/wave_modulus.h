// How stiff a law is against waves: what explicit steps have to follow.
#pragma once

#include "sim/materials/lanes.h"

namespace sim {

/// ‖C‖₂² from above. With the mean m and the second invariant J₂ of the deviator of CᵀC its largest eigenvalue is
/// m + 2 √(J₂/3) cos θ; cos θ is 1 where the smaller two are equal, and 1/2 at least.
template <class S>
[[gnu::always_inline]] inline S squared_norm_bound(const Matrix3<S>& C) {
    const auto product = [&](int i, int j) __attribute__((always_inline)) {
        return C.m[3 * i] * C.m[3 * j] + C.m[3 * i + 1] * C.m[3 * j + 1]
               + C.m[3 * i + 2] * C.m[3 * j + 2];
    };
    const S xx = product(0, 0), yy = product(1, 1), zz = product(2, 2);
    const S xy = product(0, 1), yz = product(1, 2), zx = product(2, 0);
    const S a = xx - yy, b = yy - zz, c = zz - xx;
    const S J2 = (a * a + b * b + c * c) * (1.0 / 6) + xy * xy + yz * yz + zx * zx;
    return (xx + yy + zz) * (1.0 / 3) + 2.0 * sqrt_of(S(J2 * (1.0 / 3)));
}

/// The most that a⊗b : ∂P/∂F : a⊗b is for unit vectors a and b, from above: rho c² of the fastest wave that a small motion
/// of the material can be. For an energy diagonal/2 ‖F‖² + h(J): diagonal + h'' ‖C‖₂², as J is linear in each row of F, and
/// diagonal alone where h'' < 0.   [Pa]
template <class S>
[[gnu::always_inline]] inline S wave_modulus(const Matrix3<S>& C, S diagonal, S ddh) {
    return diagonal + select_positive(ddh, S(ddh * squared_norm_bound(C)), uniform<S>(0));
}

}  // namespace sim
