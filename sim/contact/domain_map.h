// The trilinear map of a deformed domain as a polynomial, to be inverted fast.
#pragma once

#include "sim/base/field.h"

#include <array>

namespace sim {

/// a × b.
inline Vec3p cross(const Vec3p& a, const Vec3p& b) {
    const auto turned = [](const Vec3p& v) {
        return __builtin_shufflevector(v, v, 1, 2, 0, 3);
    };
    return turned(a * turned(b) - turned(a) * b);
}

/// A matrix and its inverse, A⁻¹ = cofactorsᵀ / determinant.   (3×3)
struct Gradient3 {
    std::array<Vec3p, 3> column;
    std::array<Vec3p, 3> cofactors;  // columns
    double determinant = 0;

    explicit Gradient3(const std::array<Vec3p, 3>& columns)
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

/// x(u) = Σ over sets of axes of  x_set Π u_k,  u = xi - 1/2, so that the domain is [-1/2, 1/2]³.
class DomainMap {
  public:
    /// Of corners in the order of Lattice::corners.   [m]
    explicit DomainMap(std::array<Vec3p, 8> corners) {
        // Along one axis after the other, two values become their mean and their difference.
#pragma GCC unroll 3
        for (int axis = 1; axis < 8; axis *= 2)
#pragma GCC unroll 8
            for (int a = 0; a < 8; ++a)
                if (!(a & axis)) {
                    const Vec3p low = corners[a], high = corners[a | axis];
                    corners[a] = 0.5 * (low + high);
                    corners[a | axis] = high - low;
                }
        x_ = corners;
    }

    /// x(0), the mean of the corners.   [m]
    const Vec3p& centre() const {
        return x_[0];
    }

    Vec3p at(const Vec3p& u) const {
        return x_[0] + u[2] * x_[4] + u[1] * (x_[2] + u[2] * x_[6])
               + u[0] * (x_[1] + u[2] * x_[5] + u[1] * (x_[3] + u[2] * x_[7]));
    }

    /// ∂x/∂u.   [m]
    Gradient3 gradient(const Vec3p& u) const {
        return Gradient3({x_[1] + u[1] * x_[3] + u[2] * (x_[5] + u[1] * x_[7]),
                          x_[2] + u[0] * x_[3] + u[2] * (x_[6] + u[0] * x_[7]),
                          x_[4] + u[0] * x_[5] + u[1] * (x_[6] + u[0] * x_[7])});
    }

    Gradient3 gradient_at_centre() const {
        return Gradient3({x_[1], x_[2], x_[4]});
    }

    /// How far the u that its linear part gives may be from the true one, in any axis, where |u_k| <= `most`.
    double bend(const Gradient3& at_centre, double most) const;

    /// Newton's method from u for x(u) to hit a point; false where the domain is inverted or too distorted.
    bool invert(const Vec3p& point, Vec3p& u) const;

  private:
    std::array<Vec3p, 8> x_;  // bit k of the index: u_k is a factor [m]
};

}  // namespace sim
