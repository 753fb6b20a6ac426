#include "render/scene/camera.h"

#include "assets/base/error.h"
#include "render/scene/axes.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace render {

namespace {

constexpr double degree = 3.14159265358979323846 / 180;
constexpr double sensor_width = 36;        // [mm]
constexpr double azimuth = 28 * degree;    // from the front towards the right
constexpr double elevation = 17 * degree;  // above the horizon

struct Directions {
    Vec3 right, up, forward;
};

Directions looking_along(const Vec3& forward, const Vec3& up) {
    Vec3 right = forward.cross(up);
    if (right.norm() < 1e-6)  // straight up or down: any direction may be the picture's right
        right = studio_axes(forward).right;
    right.normalize();
    return {right, right.cross(forward), forward};
}

std::vector<Vec3> corners(const std::vector<Bounds>& bounds) {
    std::vector<Vec3> points;
    points.reserve(8 * bounds.size());
    for (const auto& [min, max] : bounds)
        for (int c = 0; c < 8; ++c)
            points.emplace_back(c & 1 ? max.x() : min.x(),
                                c & 2 ? max.y() : min.y(),
                                c & 4 ? max.z() : min.z());
    return points;
}

struct Fit {
    double shift, distance;
};

// A camera at `shift` sideways and `distance` behind the origin sees the point (s, f) = (sideways, forward) inside
// the slope k where |s - shift| <= k (f + distance). Two such lines are tight for the nearest camera.
Fit tightest_fit(const std::vector<Vec3>& points,
                 const Vec3& sideways,
                 const Vec3& forward,
                 double k) {
    double high = -std::numeric_limits<double>::infinity();
    double low = high;
    for (const Vec3& point : points) {
        const double s = point.dot(sideways), f = point.dot(forward);
        high = std::max(high, s - k * f);
        low = std::max(low, -s - k * f);
    }
    return {(high - low) / 2, (high + low) / (2 * k)};
}

Vec3 framing_position(const std::vector<Vec3>& points,
                      const Directions& view,
                      double tan_w,
                      double tan_h) {
    const double slack = 1 - framing_margin;
    const Fit x = tightest_fit(points, view.right, view.forward, slack * tan_w);
    const Fit y = tightest_fit(points, view.up, view.forward, slack * tan_h);
    return x.shift * view.right + y.shift * view.up
           - std::max(x.distance, y.distance) * view.forward;
}

Vec3 framing_direction(const StudioAxes& axes) {
    const Vec3 level = std::cos(azimuth) * axes.front + std::sin(azimuth) * axes.right;
    return -(std::cos(elevation) * level + std::sin(elevation) * axes.up);
}

}  // namespace

View place_camera(const Options& options, const std::vector<Bounds>& bounds) {
    assets::check(!bounds.empty(), "a camera needs the bounds of at least one frame");
    const Camera& camera = options.camera;
    const double tan_w = sensor_width / (2 * camera.lens);
    const double tan_h = tan_w * options.height / options.width;
    const StudioAxes axes = studio_axes(options.up);

    Vec3 position = camera.position, look_at = camera.look_at;
    Directions directions;
    if (camera.frame_bodies) {
        const std::vector<Vec3> points = corners(bounds);
        Vec3 center = Vec3::Zero();
        for (const Vec3& point : points)
            center += point / double(points.size());
        directions = looking_along(framing_direction(axes), axes.up);
        position = framing_position(points, directions, tan_w, tan_h);
        look_at = center;
    } else {
        const Vec3 gaze = look_at - position;
        if (!(gaze.norm() > 0))
            throw assets::Error(assets::ErrorKind::Input,
                                "the camera looks at its own position: give another point",
                                "camera.look_at");
        directions = looking_along(gaze.normalized(), axes.up);
    }

    View view;
    view.position = position.cast<float>();
    view.right = directions.right.cast<float>();
    view.up = directions.up.cast<float>();
    view.forward = directions.forward.cast<float>();
    view.tan_half_width = float(tan_w);
    view.tan_half_height = float(tan_h);
    view.focus_distance =
        float(camera.focus.value_or((look_at - position).dot(directions.forward)));
    if (camera.f_stop)
        view.lens_radius = float(1e-3 * camera.lens / (2 * *camera.f_stop));
    return view;
}

Ray camera_ray(const View& view, float x, float y, float lens_x, float lens_y) {
    const Vec3f through = view.forward + x * view.tan_half_width * view.right
                          + y * view.tan_half_height * view.up;
    if (view.lens_radius == 0)
        return {view.position, through.normalized()};
    const Vec3f offset = view.lens_radius * (lens_x * view.right + lens_y * view.up);
    return {view.position + offset, (view.focus_distance * through - offset).normalized()};
}

}  // namespace render
