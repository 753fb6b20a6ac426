#include "render/shot_pictures.h"

#include "assets/base/error.h"
#include "render/pathtrace/path_tracer.h"
#include "render/scene/studio.h"

namespace render {

ShotPictures::ShotPictures(const std::vector<assets::CachedSurface>& surfaces,
                           const std::vector<Bounds>& bounds,
                           const Options& options)
    : options_(options) {
    check(options);
    view_ = place_camera(options, bounds);
    studio_ = make_studio(options, bounds);
    for (const assets::CachedSurface& surface : surfaces) {
        const auto look = options.looks.find({surface.body, surface.skin});
        surfaces_.emplace_back(surface, look == options.looks.end() ? Look{} : look->second);
    }
}

Scene ShotPictures::scene(const assets::Frame& frame) const {
    assets::check(frame.surfaces.size() == surfaces_.size(), "a frame has all surfaces");
    Scene scene = studio_;
    for (std::size_t s = 0; s < surfaces_.size(); ++s)
        scene.meshes.push_back(surfaces_[s].at(frame.surfaces[s]));
    return scene;
}

Image ShotPictures::picture(const assets::Frame& frame) const {
    TraceOptions trace_options;
    trace_options.width = options_.width;
    trace_options.height = options_.height;
    trace_options.samples = options_.samples;
    trace_options.seed = std::uint32_t(frame.number);
    return trace(scene(frame), view_, trace_options);
}

}  // namespace render
