// A 3×3 matrix of padded columns, to be solved with many times.
#pragma once

#include "sim/base/vectors.h"

#include <array>

namespace sim {

/// With its inverse, A⁻¹ = cofactorsᵀ / determinant.   (3×3)
struct PaddedMatrix {
    std::array<Vec3p, 3> column;
    std::array<Vec3p, 3> cofactors;  // columns
    double determinant = 0;

    explicit PaddedMatrix(const std::array<Vec3p, 3>& columns)
        : column(columns),
          cofactors{cross(column[1], column[2]),
                    cross(column[2], column[0]),
                    cross(column[0], column[1])},
          determinant(dot(column[0], cofactors[0])) {}

    /// A⁻¹ v.
    Vec3p solve(const Vec3p& v) const {
        return Vec3p{dot(cofactors[0], v), dot(cofactors[1], v), dot(cofactors[2], v), 0}
               / determinant;
    }

    /// A⁻ᵀ v.
    Vec3p solve_transposed(const Vec3p& v) const {
        return (v[0] * cofactors[0] + v[1] * cofactors[1] + v[2] * cofactors[2]) / determinant;
    }
};

}  // namespace sim
