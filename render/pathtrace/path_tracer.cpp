#include "render/pathtrace/path_tracer.h"

#include "assets/base/error.h"
#include "render/pathtrace/warp.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <fmt/core.h>

namespace render {

namespace {

constexpr int tile_size = 16;  // [pixel]

// Offset from a pixel's centre with the density of a tent that reaches to its neighbours' centres.
float tent(float u) {
    return u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u);
}

Vec3f pixel_radiance(const EmbreeScene& rays,
                     const Scene& scene,
                     const View& view,
                     const TraceOptions& options,
                     int x,
                     int y) {
    const std::uint32_t seed = hash(std::uint32_t(y * options.width + x) ^ hash(options.seed));
    Vec3f sum = Vec3f::Zero();
    for (int s = 0; s < options.samples; ++s) {
        const Sampler sampler(seed, std::uint32_t(s));
        const Pair shift = sampler.pair(0);
        const float picture_x =
            2 * (float(x) + 0.5f + tent(shift.x)) / float(options.width) - 1;
        const float picture_y =
            1 - 2 * (float(y) + 0.5f + tent(shift.y)) / float(options.height);
        const Pair lens = uniform_disc(sampler.pair(1));
        const Ray ray = camera_ray(view, picture_x, picture_y, lens.x, lens.y);
        sum += path_radiance(rays, scene, ray, sampler, options.path);
    }
    return sum / float(options.samples);
}

void check_finite(const Image& image) {
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        if (!image.pixels[i].allFinite())
            throw std::logic_error(
                fmt::format("internal fault: the light of pixel ({}, {}) is not finite",
                            int(i) % image.width,
                            int(i) / image.width));
}

}  // namespace

Image trace(const Scene& scene, const View& view, const TraceOptions& options) {
    assets::check(options.width > 0 && options.height > 0 && options.samples > 0,
                  "a picture needs pixels and samples");
    const EmbreeScene rays(scene);
    Image image{options.width, options.height, {}};
    image.pixels.resize(std::size_t(options.width) * options.height);
    const int tiles_across = (options.width + tile_size - 1) / tile_size;
    const int tiles_down = (options.height + tile_size - 1) / tile_size;
    tbb::parallel_for(0, tiles_across * tiles_down, [&](int tile) {
        const DenormalsAreZero mode;
        const int left = tile % tiles_across * tile_size, top = tile / tiles_across * tile_size;
        for (int y = top; y < std::min(top + tile_size, options.height); ++y)
            for (int x = left; x < std::min(left + tile_size, options.width); ++x)
                image.pixels[std::size_t(y) * options.width + x] =
                    pixel_radiance(rays, scene, view, options, x, y);
    });
    check_finite(image);
    return image;
}

}  // namespace render
