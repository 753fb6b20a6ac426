// Whether a body may touch itself.
#pragma once

#include "sim/contact/contact_surface.h"

#include <vector>

namespace sim {

/// Tells cheaply whether two domains near a body's surface are near each other that are no neighbours at rest. The answer
/// depends on x alone; that of earlier calls only saves work.
class FoldWatch {
  public:
    explicit FoldWatch(const ContactSurface& surface) : surface_(&surface) {}

    bool is_folded(const Field& x);

  private:
    double nearest_strangers(const Field& x, double within) const;

    const ContactSurface* surface_;
    std::vector<Vec3>
        checked_;  // (#corners) where corners were when all distances were looked at, or empty [m]
    double reach_ = 0;  // that strangers had left before they would be near [m]
};

}  // namespace sim
