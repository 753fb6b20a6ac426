// Frames of a cache become pictures.
#pragma once

#include "assets/frames/frame_cache.h"
#include "render/image/image.h"
#include "render/options.h"

#include <memory>
#include <vector>

namespace render {

/// Holds what all frames of a shot share: the camera (placed once from the bounds of `frames`), lights and scene.
class Renderer {
  public:
    Renderer(const assets::FrameCacheReader& cache,
             const std::vector<int>& frames,
             const Options& options);
    ~Renderer();

    /// The picture of one frame, linear Rec.709. The same bytes for any number of threads.
    Image render(const assets::Frame& frame);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Text that changes whenever the picture of a frame would: options, program version and camera.
std::string picture_key(const Options& options);

}  // namespace render
