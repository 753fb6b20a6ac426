// Singular values of several matrices side by side.
#pragma once

#include "sim/materials/lanes.h"

namespace sim {

/// F V = B with V a rotation and the columns of B orthogonal: their lengths are the singular values, in no order, all of
/// them positive or zero, and where det F > 0 their directions are a rotation too.
struct OrthogonalColumns {
    Matrix3<Lanes> B, V;
    Lanes defect;  // the largest (b_i·b_j)² / (b_i² b_j²) left
};

/// a·b of two columns.
[[gnu::always_inline]] inline Lanes column_dot(const Matrix3<Lanes>& A, int i, int j) {
    const Lanes *const a = A.m + 3 * i, *const b = A.m + 3 * j;
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Turns columns i and j of A in their plane.
[[gnu::always_inline]] inline void turn_columns(
    Matrix3<Lanes>& A, int i, int j, const Lanes& cosine, const Lanes& sine) {
    for (int k = 0; k < 3; ++k) {
        const Lanes a = A.m[3 * i + k], b = A.m[3 * j + k];
        A.m[3 * i + k] = cosine * a - sine * b;
        A.m[3 * j + k] = sine * a + cosine * b;
    }
}

/// One-sided Jacobi rotations of pairs of columns, by the smaller of the two angles that make them orthogonal; sweeps over
/// the three pairs until rounding is all that is left, at most eight. Requires finite F of a size whose fourth power is a normal number.
[[gnu::always_inline]] inline OrthogonalColumns orthogonal_columns(const Matrix3<Lanes>& F) {
    constexpr int most_sweeps = 8;
    constexpr double rounding = 1e-15, tiny = 1e-300;  // tiny keeps 0/0 out
    OrthogonalColumns result{F, {}, {}};
    for (int k = 0; k < 9; k += 4)
        result.V.m[k] = uniform<Lanes>(1);
    for (int sweep = 0;; ++sweep) {
        result.defect = Lanes{};
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            const Lanes c = column_dot(result.B, i, j);
            const Lanes defect =
                c * c / (column_dot(result.B, i, i) * column_dot(result.B, j, j) + tiny);
            result.defect = select_positive(defect - result.defect, defect, result.defect);
        }
        if (!(largest_lane(result.defect) > rounding * rounding) || sweep == most_sweeps)
            return result;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            const Lanes a = column_dot(result.B, i, i), b = column_dot(result.B, j, j);
            const Lanes c = 2.0 * column_dot(result.B, i, j), d = b - a;
            const Lanes size = select_positive(d, d, Lanes(-d)) + sqrt_of(Lanes(d * d + c * c));
            const Lanes tangent = select_positive(d, c, Lanes(-c)) / (size + tiny);
            const Lanes cosine = 1.0 / sqrt_of(Lanes(1.0 + tangent * tangent));
            turn_columns(result.B, i, j, cosine, tangent * cosine);
            turn_columns(result.V, i, j, cosine, tangent * cosine);
        }
    }
}

}  // namespace sim
