#include "render/scene/studio.h"

#include "assets/base/error.h"
#include "render/scene/axes.h"
#include "render/scene/props.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace render {

namespace {

const Vec3f floor_albedo(0.56f, 0.57f, 0.59f);

// Below the lowest point, in radii: so close that it looks like touching without being the same plane, and clear
// of it.
constexpr double touching_gap = 1e-3, hanging_gap = 0.18;

// What the studio is built around.
struct Stage {
    StudioAxes axes;
    Vec3 center;
    double radius;  // of a ball around center that holds all bodies at all frames
    double lowest;  // height along up, over all frames
    bool stands;    // the lowest point of each frame is at nearly the same height
};

Stage make_stage(const StudioAxes& axes, const std::vector<Bounds>& bounds) {
    Vec3f low = bounds[0].first, high = bounds[0].second;
    double lowest = std::numeric_limits<double>::infinity(), highest_foot = -lowest;
    for (const auto& [min, max] : bounds) {
        low = low.cwiseMin(min);
        high = high.cwiseMax(max);
        const Vec3 center = (0.5f * (min + max)).cast<double>(),
                   half = (0.5f * (max - min)).cast<double>();
        const double foot = center.dot(axes.up) - half.dot(axes.up.cwiseAbs());
        lowest = std::min(lowest, foot);
        highest_foot = std::max(highest_foot, foot);
    }
    const double radius = std::max(0.5 * double((high - low).norm()), 1e-6);
    const Vec3 center = (0.5f * (low + high)).cast<double>();
    return {axes, center, radius, lowest, highest_foot - lowest < 0.02 * radius};
}

// A light at `direction` times `distance` from the centre, turned to it, that brings `irradiance` there.
RectangleLight light_from(const Stage& stage,
                          const Vec3& direction,
                          double distance,
                          double half_size,
                          const Vec3& irradiance) {
    const Vec3 away = direction.normalized();
    const Vec3 u = stage.axes.up.cross(away).normalized() * half_size;
    const Vec3 v = away.cross(u);
    const double area = 4 * half_size * half_size;
    RectangleLight light;
    light.center = (stage.center + distance * away).cast<float>();
    light.half_u = v.cast<float>();  // v × u points back to the centre
    light.half_v = u.cast<float>();
    light.radiance = (irradiance * (distance * distance / area)).cast<float>();
    return light;
}

// A big soft key from the upper left, a cool rim from behind on the right; the sky fills.
std::vector<RectangleLight> studio_lights(const Stage& stage) {
    const auto& [right, up, front] = stage.axes;
    const double r = stage.radius;
    return {light_from(stage,
                       -0.75 * right + 1.25 * up + 0.85 * front,
                       4.2 * r,
                       1.35 * r,
                       {2.75, 2.64, 2.46}),
            light_from(stage,
                       1.0 * right + 0.75 * up - 1.0 * front,
                       4.5 * r,
                       0.9 * r,
                       {1.10, 1.18, 1.32})};
}

Floor make_floor(const Stage& stage, const Vec3& point, const Vec3& normal) {
    Floor floor;
    const Vec3 n = normal.normalized();
    floor.point = (stage.center - n.dot(stage.center - point) * n).cast<float>();
    floor.normal = n.cast<float>();
    floor.albedo = floor_albedo;
    floor.fade_start = float(1.5 * stage.radius);
    floor.fade_end = float(7 * stage.radius);
    return floor;
}

std::vector<Floor> make_floors(const Stage& stage, const std::vector<Prop>& props) {
    const Vec3& up = stage.axes.up;
    std::vector<Floor> floors;
    bool floor_below = false;
    for (const Prop& prop : props)
        if (prop.kind == Prop::Kind::Plane) {
            floors.push_back(make_floor(stage, prop.point, prop.normal));
            floor_below = floor_below || prop.normal.normalized().dot(up) > 0.5;
        }
    if (!floor_below) {
        const double height =
            stage.lowest - (stage.stands ? touching_gap : hanging_gap) * stage.radius;
        floors.push_back(make_floor(stage, height * up, up));
    }
    return floors;
}

Dome make_sky(const Vec3& up) {
    Dome sky;
    sky.up = up.cast<float>();
    sky.zenith = {0.44f, 0.48f, 0.54f};
    sky.horizon = {0.32f, 0.33f, 0.35f};
    sky.nadir = {0.16f, 0.16f, 0.16f};
    return sky;
}

// Below the horizon about what the far floor sends, so that the floor fades without a seam.
Dome make_backdrop(const Vec3& up) {
    Dome backdrop;
    backdrop.up = up.cast<float>();
    backdrop.nadir = {0.44f, 0.47f, 0.52f};
    backdrop.horizon = {0.40f, 0.43f, 0.48f};
    backdrop.zenith = {0.20f, 0.24f, 0.30f};
    return backdrop;
}

}  // namespace

Scene make_studio(const Options& options, const std::vector<Bounds>& bounds) {
    assets::check(!bounds.empty(), "a studio needs the bounds of at least one frame");
    const Stage stage = make_stage(studio_axes(options.up), bounds);
    Scene scene;
    for (const Prop& prop : options.props)
        if (prop.kind != Prop::Kind::Plane)
            scene.meshes.push_back(prop_mesh(prop));
    scene.floors = make_floors(stage, options.props);
    scene.lights = studio_lights(stage);
    scene.sky = make_sky(stage.axes.up);
    scene.backdrop = make_backdrop(stage.axes.up);
    return scene;
}

}  // namespace render
