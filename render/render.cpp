#include "render/render.h"

#include "assets/base/error.h"
#include "render/shot_pictures.h"

#include <utility>

namespace render {

namespace {

std::vector<Bounds> bounds_of(const assets::FrameCacheReader& cache,
                              const std::vector<int>& frames) {
    if (frames.empty())
        throw assets::Error(
            assets::ErrorKind::Input, "there is no frame to render: simulate first", "frames");
    std::vector<Bounds> bounds;
    for (const int number : frames)
        bounds.push_back(cache.bounds(number));
    return bounds;
}

}  // namespace

// The surfaces are copied, so that the renderer may outlive the cache's reader.
struct Renderer::Impl {
    std::vector<assets::CachedSurface> surfaces;
    ShotPictures pictures;

    Impl(const assets::FrameCacheReader& cache,
         const std::vector<int>& frames,
         const Options& options)
        : surfaces(cache.surfaces()), pictures(surfaces, bounds_of(cache, frames), options) {}
};

Renderer::Renderer(const assets::FrameCacheReader& cache,
                   const std::vector<int>& frames,
                   const Options& options)
    : impl_(std::make_unique<Impl>(cache, frames, options)) {}

Renderer::~Renderer() = default;

Image Renderer::render(const assets::Frame& frame) {
    return impl_->pictures.picture(frame);
}

}  // namespace render
