// The renderer on plain data, without a cache on disk.
#pragma once

#include "assets/frames/frame_cache.h"
#include "render/image/image.h"
#include "render/options.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"
#include "render/scene/surfaces.h"

#include <vector>

namespace render {

/// What all pictures of a shot share.
class ShotPictures {
  public:
    /// `surfaces` must live longer; `bounds`: one per frame, not empty. Throws Error(Input) as check(options).
    ShotPictures(const std::vector<assets::CachedSurface>& surfaces,
                 const std::vector<Bounds>& bounds,
                 const Options& options);

    /// The picture of one frame, linear Rec.709.
    Image picture(const assets::Frame& frame) const;

    /// Studio and bodies at a frame.
    Scene scene(const assets::Frame& frame) const;

    const View& view() const { return view_; }

  private:
    Options options_;
    View view_;
    Scene studio_;
    std::vector<Surface> surfaces_;
};

}  // namespace render
