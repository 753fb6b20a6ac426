// Colliders as surfaces of the frame cache, so that pictures show those that move or are no simple shape.
#pragma once

#include "assets/frames/frame_cache.h"
#include "sim/contact/moving_collider.h"

namespace sim {

class ColliderSurface {
  public:
    /// `resolution`: the smallest domain's edge [m]. The surface is named "collider"/`index`.
    ColliderSurface(const Collider& collider, int index, double resolution);

    const assets::CachedSurface& cached() const { return cached_; }

    assets::SurfaceFrame at(double time) const;

  private:
    MovingCollider motion_;
    assets::CachedSurface cached_;
    std::vector<Vec3> normals_;  // (#V) at rest
};

}  // namespace sim
