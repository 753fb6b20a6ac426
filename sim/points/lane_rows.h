// Matrices of points to lanes and back: four rows of four are transposed in registers.
#pragma once

#include "sim/base/field.h"
#include "sim/grid/corner_map.h"
#include "sim/materials/lanes.h"

#include <cstring>

namespace sim {

static_assert(lane_count % 4 == 0);

/// Entry j of row[i] goes to entry i of row[j].
[[gnu::always_inline]] inline void transpose(Vec3p* row) {
    const Vec3p a = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
    const Vec3p b = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
    const Vec3p c = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
    const Vec3p d = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
    row[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    row[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    row[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/// Lanes [4 part, 4 part + 4) of `lanes`.
[[gnu::always_inline]] inline Vec3p quarter(const Lanes& lanes, int part) {
    Vec3p four;
    std::memcpy(&four, reinterpret_cast<const double*>(&lanes) + 4 * part, sizeof four);
    return four;
}

[[gnu::always_inline]] inline void set_quarter(Lanes& lanes, int part, const Vec3p& four) {
    std::memcpy(reinterpret_cast<double*>(&lanes) + 4 * part, &four, sizeof four);
}

/// Lane l is the matrix at[l].
[[gnu::always_inline]] inline Matrix3<Lanes> load_lanes(const Matrix3<double>* const* at) {
    Matrix3<Lanes> F;
#pragma GCC unroll 2
    for (int part = 0; part < lane_count / 4; ++part, at += 4) {
#pragma GCC unroll 2
        for (int k = 0; k < 8; k += 4) {
            Vec3p row[4];
            for (int l = 0; l < 4; ++l)
                std::memcpy(&row[l], at[l]->m + k, sizeof row[l]);
            transpose(row);
            for (int j = 0; j < 4; ++j)
                set_quarter(F.m[k + j], part, row[j]);
        }
        set_quarter(F.m[8], part, Vec3p{at[0]->m[8], at[1]->m[8], at[2]->m[8], at[3]->m[8]});
    }
    return F;
}

/// Puts lane l in at[l], of all lanes.
[[gnu::always_inline]] inline void store_lanes(const Matrix3<Lanes>& F,
                                               Matrix3<double>* const* at) {
#pragma GCC unroll 2
    for (int part = 0; part < lane_count / 4; ++part, at += 4) {
#pragma GCC unroll 2
        for (int k = 0; k < 8; k += 4) {
            Vec3p row[4];
            for (int j = 0; j < 4; ++j)
                row[j] = quarter(F.m[k + j], part);
            transpose(row);
            for (int l = 0; l < 4; ++l)
                std::memcpy(at[l]->m + k, &row[l], sizeof row[l]);
        }
        const Vec3p last = quarter(F.m[8], part);
        for (int l = 0; l < 4; ++l)
            at[l]->m[8] = last[l];
    }
}

/// Lane l is values[l], of all lanes.
[[gnu::always_inline]] inline Matrix3<Lanes> load_lanes(const Gradient* values) {
    Matrix3<Lanes> D;
#pragma GCC unroll 2
    for (int part = 0; part < lane_count / 4; ++part, values += 4)
#pragma GCC unroll 3
        for (int c = 0; c < 3; ++c) {
            Vec3p row[4];
            for (int l = 0; l < 4; ++l)
                row[l] = values[l].column[c];
            transpose(row);
            for (int i = 0; i < 3; ++i)
                set_quarter(D.m[3 * c + i], part, row[i]);
        }
    return D;
}

/// Puts lane l in values[l], of all lanes.
[[gnu::always_inline]] inline void store_lanes(const Matrix3<Lanes>& A, Gradient* values) {
#pragma GCC unroll 2
    for (int part = 0; part < lane_count / 4; ++part, values += 4)
#pragma GCC unroll 3
        for (int c = 0; c < 3; ++c) {
            Vec3p row[4] = {};
            for (int i = 0; i < 3; ++i)
                row[i] = quarter(A.m[3 * c + i], part);
            transpose(row);
            for (int l = 0; l < 4; ++l)
                values[l].column[c] = row[l];
        }
}

}  // namespace sim
