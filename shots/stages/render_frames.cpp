#include "shots/stages/render_frames.h"

#include "assets/base/error.h"
#include "assets/frames/frame_cache.h"
#include "assets/frames/layout.h"
#include "render/image/image.h"
#include "render/render.h"
#include "shots/stages/interruption.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace shots {
namespace {

constexpr const char* stamp_key = "supple";  // of the PNG text chunk

/// Frames of the shot that the cache holds.
std::vector<int> cached_frames(const RenderJob& job, const assets::FrameCacheReader& cache) {
    const std::vector<int> held = cache.frames();
    std::vector<int> frames;
    for (const int number : job.shot_frames)
        if (std::find(held.begin(), held.end(), number) != held.end())
            frames.push_back(number);
    return frames;
}

void require_frames(const RenderJob& job, const std::vector<int>& cached) {
    for (const int number : job.frames)
        if (std::find(cached.begin(), cached.end(), number) == cached.end())
            throw assets::Error(
                assets::ErrorKind::Input,
                fmt::format("frame {} is not in {}: simulate it first (supple sim)",
                            number,
                            job.cache.string()));
}

/// Bounds of all frames together as text: they place the camera.
std::string bounds_text(const assets::FrameCacheReader& cache, const std::vector<int>& frames) {
    auto [low, high] = cache.bounds(frames.front());
    for (const int number : frames) {
        const auto [frame_low, frame_high] = cache.bounds(number);
        low = low.cwiseMin(frame_low);
        high = high.cwiseMax(frame_high);
    }
    return fmt::format(
        "[{}, {}, {}] [{}, {}, {}]", low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
}

/// The pictures to be, in the order of job.frames.
std::vector<Picture> planned_pictures(const RenderJob& job,
                                      const assets::FrameCacheReader& cache,
                                      const std::vector<int>& cached) {
    assets::Fingerprint stamp{{"options", render::picture_key(job.options)},
                              {"surfaces", cache.surfaces_checksum()},
                              {"bounds", bounds_text(cache, cached)}};
    std::vector<Picture> pictures;
    for (const int number : job.frames) {
        stamp["frame"] = fmt::format("{:016x}", cache.checksum(number));
        pictures.push_back(
            {number,
             job.images / fmt::format("{}.{}.png", job.name, assets::padded(number)),
             assets::digest(stamp)});
    }
    return pictures;
}

bool is_done(const Picture& picture) {
    const auto text = render::read_png_text(picture.file);
    const auto found = text.find(stamp_key);
    return found != text.end() && found->second == picture.stamp;
}

}  // namespace

std::vector<Picture> render_frames(const RenderJob& job, Progress& progress) {
    const assets::FrameCacheReader cache(job.cache);
    const std::vector<int> cached = cached_frames(job, cache);
    require_frames(job, cached);
    const std::vector<Picture> pictures = planned_pictures(job, cache, cached);

    std::vector<Picture> missing;
    std::copy_if(pictures.begin(),
                 pictures.end(),
                 std::back_inserter(missing),
                 [&](const Picture& picture) { return job.overwrite || !is_done(picture); });
    const auto n_pictures = static_cast<int>(pictures.size());
    if (missing.empty()) {
        progress.say(fmt::format(
            "render: all {} pictures are in {} already", n_pictures, job.images.string()));
        return pictures;
    }

    std::filesystem::create_directories(job.images);
    render::Renderer renderer(cache, cached, job.options);
    progress.start("render", n_pictures, n_pictures - static_cast<int>(missing.size()));
    for (const Picture& picture : missing) {
        stop_if_interrupted();
        render::write_png(picture.file,
                          renderer.render(cache.read(picture.frame)),
                          {{stamp_key, picture.stamp}});
        progress.advance(fmt::format("frame {}", picture.frame));
    }
    progress.finish();
    return pictures;
}

}  // namespace shots
