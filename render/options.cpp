#include "render/options.h"

#include "assets/base/error.h"
#include "render/render.h"

#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace render {

namespace {

// Raise when the same options give another picture.
constexpr int picture_version = 2;

void require(bool condition, const std::string& message, const char* key) {
    if (!condition)
        throw assets::Error(assets::ErrorKind::Input, message, key);
}

bool positive(double value) {
    return value > 0 && std::isfinite(value);
}

std::string text(const Vec3& v) {
    return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

std::string text(const Look& look) {
    constexpr std::string_view names[] = {"look", "region", "stretch"};
    return fmt::format("color [{}, {}, {}] by {}, {}, roughness {}, opacity {}",
                       look.color.x(),
                       look.color.y(),
                       look.color.z(),
                       names[int(look.color_by)],
                       look.coated ? "coated" : "matt",
                       look.roughness,
                       look.opacity);
}

std::string text(const Camera& camera) {
    const std::string place =
        camera.frame_bodies
            ? "frames bodies"
            : fmt::format("at {} looks at {}", text(camera.position), text(camera.look_at));
    return fmt::format("{}, lens {}, focus {}, f_stop {}",
                       place,
                       camera.lens,
                       camera.focus ? fmt::to_string(*camera.focus) : "auto",
                       camera.f_stop ? fmt::to_string(*camera.f_stop) : "none");
}

std::string text(const Prop& prop) {
    switch (prop.kind) {
        case Prop::Kind::Plane:
            return fmt::format("plane {} {}", text(prop.point), text(prop.normal));
        case Prop::Kind::Sphere:
            return fmt::format("sphere {} {}", text(prop.center), prop.radius);
        case Prop::Kind::Box:
            break;
    }
    return fmt::format("box {} {}", text(prop.min), text(prop.max));
}

}  // namespace

void check(const Options& options) {
    constexpr int max_size = 16384, max_samples = 1 << 20;
    require(options.width >= 1 && options.height >= 1 && options.width <= max_size
                && options.height <= max_size,
            fmt::format("a picture of {} x {} pixels: each side may be 1 to {}",
                        options.width,
                        options.height,
                        max_size),
            "output.size");
    require(options.samples >= 1 && options.samples <= max_samples,
            fmt::format("{} samples per pixel: 1 to {} are allowed, 64 is usual",
                        options.samples,
                        max_samples),
            "output.samples");
    const Camera& camera = options.camera;
    require(positive(camera.lens),
            fmt::format("a lens of {} mm: it must be positive, 50 is usual", camera.lens),
            "camera.lens");
    require(!camera.focus || positive(*camera.focus),
            fmt::format("a focus of {} m: it must be positive", camera.focus.value_or(0)),
            "camera.focus");
    require(!camera.f_stop || positive(*camera.f_stop),
            fmt::format("an f_stop of {}: it must be positive, 2.8 is usual",
                        camera.f_stop.value_or(0)),
            "camera.f_stop");
    require(options.light_rig == "studio",
            fmt::format("there is no light rig \"{}\": \"studio\" is the one there is",
                        options.light_rig),
            "light.rig");
    for (const auto& [name, look] : options.looks) {
        const std::string whose =
            fmt::format("the look of skin \"{}\" of body \"{}\"", name.second, name.first);
        const std::string key = "body." + name.first + ".skin";
        require(
            look.roughness >= 0 && look.roughness <= 1,
            fmt::format("{} has a roughness of {}: 0 to 1 is allowed", whose, look.roughness),
            key.c_str());
        require(look.opacity >= 0 && look.opacity <= 1,
                fmt::format("{} has an opacity of {}: 0 to 1 is allowed", whose, look.opacity),
                key.c_str());
        require(look.color.minCoeff() >= 0 && look.color.maxCoeff() <= 1,
                fmt::format("{} has a colour outside of 0 to 1", whose),
                key.c_str());
    }
}

std::string picture_key(const Options& options) {
    std::string key =
        fmt::format("picture {}\nsize {} x {}\nsamples {}\nup {}\ncamera {}\nlight {}\n",
                    picture_version,
                    options.width,
                    options.height,
                    options.samples,
                    text(options.up),
                    text(options.camera),
                    options.light_rig);
    for (const auto& [name, look] : options.looks)
        key += fmt::format("look {}/{}: {}\n", name.first, name.second, text(look));
    for (const Prop& prop : options.props)
        key += fmt::format("prop {}\n", text(prop));
    return key;
}

}  // namespace render
