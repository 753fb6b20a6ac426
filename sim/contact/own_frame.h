// The frame of a body, which flies and turns with it.
#pragma once

#include "sim/base/field.h"

#include <array>

namespace sim {

/// Seen from it, a body that only flies and turns does not move.
struct OwnFrame {
    Vec3p centre{};                 // mean of the corners [m]
    std::array<Vec3p, 3> column{};  // of the rotation into the frame

    Vec3p seen(const Vec3p& x) const {
        const Vec3p from_centre = x - centre;
        return from_centre[0] * column[0] + from_centre[1] * column[1]
               + from_centre[2] * column[2];
    }

    /// By how much a unit vector seen from both differs, at most: |R - R'| = 2 sin(angle / 2).
    double turn_from(const OwnFrame& other) const;
};

/// What tells the frame, summed over corners. Its rotation is the nearest to Σ (X - X_mean) xᵀ.
class FrameSums {
  public:
    void add(const Vec3p& x, const Vec3p& from_rest_centre) {
        sum_ += x;
        for (int k = 0; k < 3; ++k)
            column_[k] += from_rest_centre[k] * x;
    }

    OwnFrame frame(std::size_t n_corners) const;

  private:
    Vec3p sum_{};
    std::array<Vec3p, 3> column_{};  // of Σ x (X - X_mean)ᵀ
};

}  // namespace sim
