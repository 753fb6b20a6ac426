// The cached surfaces of bodies, dressed for a picture.
#pragma once

#include "assets/frames/frame_cache.h"
#include "render/options.h"
#include "render/scene/creases.h"
#include "render/scene/scene.h"

namespace render {

/// One surface with what does not change over its frames.
class Surface {
  public:
    /// `cached` must live longer. Throws Error(Input) where the look of a varying surface is clear: what lies inside
    /// of it, and how deep, is not known over the shot.
    Surface(const assets::CachedSurface& cached, const Look& look);

    /// The surface at a frame. Throws std::logic_error where the frame's arrays do not fit the surface, or where the
    /// look asks for a stretch that the frame does not hold.
    Mesh at(const assets::SurfaceFrame& frame) const;

  private:
    /// Of all vertices, 0..1.
    std::vector<Vec3f> colors(const assets::SurfaceFrame& frame) const;
    Mesh varying_at(const assets::SurfaceFrame& frame) const;

    const assets::CachedSurface& cached_;
    Look look_;
    SplitTopology topology_;
    Material material_;
};

/// Colour (linear) of a stretch: dark violet at 1 and below, over teal, to yellow at 2 and above; brightness rises
/// evenly, so that it reads in grey as well. Knots of the map "viridis" [Smith & van der Walt 2015].
Vec3f stretch_color(float stretch);

}  // namespace render
