// A smooth signed distance for contact.
#pragma once

#include "assets/generators/solid.h"

#include <array>
#include <vector>

namespace assets {

/// A solid's signed distance as a quadratic B-spline on a dense grid: its gradient is continuous everywhere, also where
/// that of the distance jumps (across the middle of the solid, near edges), which a Newton solve needs. Linear distances
/// are reproduced exactly; edges and curved surfaces lie off by about curvature · voxel²/8.
class DistanceField {
  public:
    /// Samples `solid` with cells of `voxel` in its bounds and two cells around.   [m]
    DistanceField(const Solid& solid, double voxel);

    /// Signed distance [m] and its gradient; outside the grid a lower bound of the distance, with the gradient away from
    /// the solid's bounds.
    double at(const Vec3& x, Vec3& gradient) const;

  private:
    double value(int i, int j, int k) const {
        return values_[static_cast<std::size_t>(i)
                       + n_[0]
                             * (static_cast<std::size_t>(j)
                                + n_[1] * static_cast<std::size_t>(k))];
    }

    Vec3 low_{0, 0, 0};  // of the grid's first value [m]
    double voxel_ = 0;
    std::array<std::size_t, 3> n_{};  // values along each axis
    std::vector<float> values_;
};

}  // namespace assets
