// The trilinear map of a deformed domain as a polynomial, to be inverted fast.
#pragma once

#include "sim/contact/padded_matrix.h"

#include <array>

namespace sim {

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
    PaddedMatrix gradient(const Vec3p& u) const {
        return PaddedMatrix({x_[1] + u[1] * x_[3] + u[2] * (x_[5] + u[1] * x_[7]),
                             x_[2] + u[0] * x_[3] + u[2] * (x_[6] + u[0] * x_[7]),
                             x_[4] + u[0] * x_[5] + u[1] * (x_[6] + u[0] * x_[7])});
    }

    PaddedMatrix gradient_at_centre() const {
        return PaddedMatrix({x_[1], x_[2], x_[4]});
    }

    /// How far the u that its linear part gives may be from the true one, in any axis, where |u_k| <= `most`.
    double bend(const PaddedMatrix& at_centre, double most) const;

    /// Newton's method from u for x(u) to hit a point; false where the domain is inverted or too distorted.
    bool invert(const Vec3p& point, Vec3p& u) const;

  private:
    std::array<Vec3p, 8> x_;  // bit k of the index: u_k is a factor [m]
};

}  // namespace sim
