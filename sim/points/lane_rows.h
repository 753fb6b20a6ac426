// Matrices of points to lanes and back: four rows of four, lanes or not, are transposed in registers.
#pragma once

#include "sim/base/field.h"
#include "sim/grid/corner_map.h"
#include "sim/materials/lanes.h"

#include <cstring>

namespace sim {

static_assert(sizeof(Lanes) == sizeof(Vec3p));

/// Lane l is the matrix at[l].
[[gnu::always_inline]] inline Matrix3<Lanes> load_lanes(const Matrix3<double>* const* at) {
    Matrix3<Lanes> F;
#pragma GCC unroll 2
    for (int k = 0; k < 8; k += 4) {
        for (int l = 0; l < 4; ++l)
            std::memcpy(&F.m[k + l], at[l]->m + k, sizeof F.m[k + l]);
        transpose(F.m + k);
    }
    F.m[8] = Lanes{at[0]->m[8], at[1]->m[8], at[2]->m[8], at[3]->m[8]};
    return F;
}

/// Puts lane l in at[l], of all lanes.
[[gnu::always_inline]] inline void store_lanes(const Matrix3<Lanes>& F,
                                               Matrix3<double>* const* at) {
#pragma GCC unroll 2
    for (int k = 0; k < 8; k += 4) {
        Lanes row[4] = {F.m[k], F.m[k + 1], F.m[k + 2], F.m[k + 3]};
        transpose(row);
        for (int l = 0; l < 4; ++l)
            std::memcpy(at[l]->m + k, &row[l], sizeof row[l]);
    }
    for (int l = 0; l < 4; ++l)
        at[l]->m[8] = F.m[8][l];
}

/// Lane l is values[l], of all lanes.
[[gnu::always_inline]] inline Matrix3<Lanes> load_lanes(const Gradient* values) {
    Matrix3<Lanes> D;
#pragma GCC unroll 3
    for (int c = 0; c < 3; ++c) {
        Lanes row[4];
        for (int l = 0; l < 4; ++l)
            row[l] = values[l].column[c];
        transpose(row);
        for (int i = 0; i < 3; ++i)
            D.m[3 * c + i] = row[i];
    }
    return D;
}

/// Puts lane l in values[l], of all lanes.
[[gnu::always_inline]] inline void store_lanes(const Matrix3<Lanes>& A, Gradient* values) {
#pragma GCC unroll 3
    for (int c = 0; c < 3; ++c) {
        Lanes row[4] = {A.m[3 * c], A.m[3 * c + 1], A.m[3 * c + 2], Lanes{}};
        transpose(row);
        for (int l = 0; l < 4; ++l)
            values[l].column[c] = row[l];
    }
}

}  // namespace sim
