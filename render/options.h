// What the picture shall look like, as plain data: the renderer's input beside the frame cache.
#pragma once

#include "assets/base/vector_types.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace render {

enum class ColorBy { Look, Region, Stretch };

/// Surface appearance of one skin. Colours are sRGB as typed in the shot file, 0..1.
struct Look {
    Vec3f color{0.8f, 0.8f, 0.8f};
    ColorBy color_by = ColorBy::Region;
    bool coated = true;      // under a clear glossy coat; otherwise matt, as snow is
    float roughness = 0.5f;  // of the coat, 0..1
    float opacity = 1.0f;    // below 1: a clear, slightly tinted body that shows what is inside
};

struct Camera {
    bool frame_bodies = true;  // place so that all bodies are seen over the whole shot
    Vec3 position{0, 0, 0}, look_at{0, 0, 0};  // used otherwise [m]
    double lens = 50;                          // focal length on a 36 mm wide sensor [mm]
    std::optional<double> focus;               // distance [m]; with f_stop: depth of field
    std::optional<double> f_stop;
};

/// A surface that the shot's colliders show: planes as a floor, spheres and boxes as they are.
struct Prop {
    enum class Kind { Plane, Sphere, Box } kind = Kind::Plane;
    Vec3 point{0, 0, 0}, normal{0, 0, 1};  // plane
    Vec3 center{0, 0, 0};                  // sphere
    double radius = 0;
    Vec3 min{0, 0, 0}, max{0, 0, 0};  // box
};

struct Options {
    int width = 960, height = 540;  // [pixel]
    int samples = 64;               // per pixel
    Vec3 up{0, 1, 0};
    Camera camera;
    std::string light_rig = "studio";
    std::map<std::pair<std::string, std::string>, Look> looks;  // (body, skin) -> look
    std::vector<Prop> props;
};

/// Throws Error(Input) naming the first field out of its range, what it is and what is allowed.
void check(const Options& options);

}  // namespace render
