// How many cells of the background grid bodies may spread over.
#pragma once

#include "assets/base/error.h"
#include "sim/base/field.h"

#include <cmath>

namespace sim {

/// Corners or points lie further apart than a grid can hold, or nowhere. Who knows the scene tells whose and when.
class FlownApart : public assets::Error {
  public:
    FlownApart()
        : Error(assets::ErrorKind::Diverged,
                "bodies spread over more background cells than can be held; they have flown "
                "apart") {}
};

/// Throws FlownApart unless a box with so many cells or nodes along each axis can be held. `sum` of the coordinates in it:
/// not finite where one is not, which comparisons would pass over.
inline void check_spread(const Vec3p& size, const Vec3p& sum) {
    constexpr double most = 1 << 28;
    if (!(size[0] * size[1] * size[2] < most) || !std::isfinite(sum[0] + sum[1] + sum[2]))
        throw FlownApart();
}

}  // namespace sim
