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
    /// Samples `solid` with cells of `voxel` in its bounds, two cells and the `margin` around.   [m]
    DistanceField(const Solid& solid, double voxel, double margin = 0);

    /// Signed distance [m] and its gradient. Where the solid's bounds are further than margin + voxel, a lower bound that
    /// is larger than that, goes on where the grid ends, and is at least 0.7 of the distance (of the band of a level set
    /// that is narrower); with a unit vector away from the grid.
    double at(const Vec3& x, Vec3& gradient) const;

  private:
    double interpolated(const Vec3& scaled, Vec3& gradient) const;

    Vec3 low_{0, 0, 0};  // of the grid's first value [m]
    double voxel_ = 0;
    // From the solid's bounds to where no values are left to interpolate [m]
    double clearance_ = 0;
    std::array<std::size_t, 3> n_{};  // values along each axis
    std::vector<float> values_;
};

}  // namespace assets
