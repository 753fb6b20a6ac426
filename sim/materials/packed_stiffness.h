// The symmetric 9×9 matrix dP/dF as its 45 entries A[packed(r, c)], r <= c, and the part of it that
// the laws share. Rows and columns are in vec order: entry 3j + i is that of F_ij.
#pragma once

#include "sim/materials/lanes.h"

namespace sim {

inline constexpr int packed_size = 45;

/// Where entry (r, c) stands, the upper triangle being stored row by row.
constexpr int packed(int r, int c) {
    return r <= c ? 9 * r - r * (r - 1) / 2 + (c - r) : packed(c, r);
}

/// Sets A to `diagonal` times the identity plus the stiffness of an energy h(J), dh = h' and ddh = h'':
///   A = diagonal I + h'' vec(C) vec(C)^T + h' ∂C/∂F,   C = cofactor(F),   ∂C_ij/∂F_kl = ε_ikm ε_jln F_mn.
template <class S>
[[gnu::always_inline]] inline void set_stiffness(
    const Matrix3<S>& F, const Matrix3<S>& C, S diagonal, S dh, S ddh, S* A) {
#pragma GCC unroll 9
    for (int r = 0; r < 9; ++r) {
        const S scaled = ddh * C.m[r];
        A[packed(r, r)] = diagonal + scaled * C.m[r];
#pragma GCC unroll 9
        for (int c = r + 1; c < 9; ++c)
            A[packed(r, c)] = scaled * C.m[c];
    }
    // Each F_mn stands in two entries of ∂C/∂F: rows i, k other than m and columns j, l other than n.
#pragma GCC unroll 9
    for (int entry = 0; entry < 9; ++entry) {
        const int m = entry % 3, i = (m + 1) % 3, k = (m + 2) % 3;
        const int n = entry / 3, j = (n + 1) % 3, l = (n + 2) % 3;
        const S product = dh * F.m[entry];
        S& same = A[packed(3 * j + i, 3 * l + k)];
        S& crossed = A[packed(3 * j + k, 3 * l + i)];
        same = same + product;
        crossed = crossed - product;
    }
}

}  // namespace sim
