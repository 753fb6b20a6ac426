#include "assets/base/error.h"
#include "render/scene/camera.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <cmath>

using namespace render;

namespace {

// Largest |coordinate| in the picture (-1..1) over all corners; infinite for what is behind the camera.
Vec3 farthest_corner(const View& view, const std::vector<Bounds>& bounds) {
    Vec3 farthest = Vec3::Zero();
    for (const auto& [min, max] : bounds)
        for (int c = 0; c < 8; ++c) {
            const Vec3f corner(c & 1 ? max.x() : min.x(),
                               c & 2 ? max.y() : min.y(),
                               c & 4 ? max.z() : min.z());
            const Vec3f d = corner - view.position;
            const float depth = d.dot(view.forward);
            REQUIRE(depth > 0);
            farthest.x() =
                std::max(farthest.x(),
                         double(std::abs(d.dot(view.right)) / depth / view.tan_half_width));
            farthest.y() = std::max(
                farthest.y(), double(std::abs(d.dot(view.up)) / depth / view.tan_half_height));
        }
    return farthest;
}

Options explicit_camera() {
    Options options;
    options.camera.frame_bodies = false;
    options.camera.position = {1, 2, 5};
    options.camera.look_at = {0, 0.5, 0};
    return options;
}

}  // namespace

TEST_CASE("framing shows all bodies at all frames, tightly") {
    const std::vector<std::vector<Bounds>> shots{
        {{{0, -0.075f, -0.075f}, {0.45f, 0.075f, 0.075f}},
         {{0, -0.3f, -0.1f}, {0.42f, 0.075f, 0.1f}}},
        {{{-1, 0, -1}, {1, 8, 1}}},
        {{{100, 100, 100}, {101, 101, 101}}, {{104, 100, 90}, {105, 101, 91}}},
        {{{0, 0, 0}, {30, 0, 30}}}};
    for (const auto& bounds : shots)
        for (const Vec3& up :
             {Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, -2, 0), Vec3(1, 1, 0.5)})
            for (const auto& [width, height] :
                 {std::pair{960, 540}, {540, 960}, {400, 400}, {2000, 200}})
                for (const double lens : {20.0, 50.0, 200.0}) {
                    Options options;
                    options.up = up;
                    options.width = width, options.height = height;
                    options.camera.lens = lens;
                    const View view = place_camera(options, bounds);
                    const Vec3 farthest = farthest_corner(view, bounds);
                    CAPTURE(up.transpose(), width, height, lens, farthest.transpose());
                    const double allowed = 1 - framing_margin;
                    CHECK(farthest.x() <= allowed + 1e-3);
                    CHECK(farthest.y() <= allowed + 1e-3);
                    CHECK(std::max(farthest.x(), farthest.y()) > allowed - 1e-3);
                    CHECK(view.up.dot(up.cast<float>()) > 0);       // the picture is upright
                    CHECK(view.forward.dot(up.cast<float>()) < 0);  // and seen from above
                }
}

TEST_CASE("a camera without extent to frame still stands somewhere") {
    const View view = place_camera(Options{}, {{{1, 2, 3}, {1, 2, 3}}});
    CHECK(view.position.allFinite());
    CHECK(camera_ray(view, 0.3f, -0.2f, 0, 0).direction.allFinite());
}

TEST_CASE("the middle of the picture is what the camera looks at") {
    const Options options = explicit_camera();
    const View view = place_camera(options, {{Vec3f::Zero(), Vec3f::Ones()}});
    const Ray ray = camera_ray(view, 0, 0, 0, 0);
    const Vec3f gaze =
        (options.camera.look_at - options.camera.position).cast<float>().normalized();
    CHECK((ray.direction - gaze).norm() < 1e-6f);
    CHECK((ray.origin - Vec3f(1, 2, 5)).norm() == 0);
    CHECK(view.right.cross(view.up).dot(view.forward) == Approx(-1));  // not mirrored
}

TEST_CASE("the lens sets the angle of view on a sensor of 36 mm") {
    Options options = explicit_camera();
    options.camera.lens = 18;  // half the sensor's width: 45 degrees to each side
    const View view = place_camera(options, {{Vec3f::Zero(), Vec3f::Ones()}});
    const Ray ray = camera_ray(view, 1, 0, 0, 0);
    CHECK(ray.direction.dot(view.forward) == Approx(std::sqrt(0.5)));
    CHECK(ray.direction.dot(view.right) == Approx(std::sqrt(0.5)));
}

TEST_CASE("rays through any part of the lens meet in focus") {
    Options options = explicit_camera();
    options.camera.focus = 3.0;
    options.camera.f_stop = 1.4;
    const View view = place_camera(options, {{Vec3f::Zero(), Vec3f::Ones()}});
    CHECK(view.lens_radius == Approx(0.050 / 1.4 / 2));
    const auto in_focus = [&](const Ray& ray) -> Vec3f {
        const float t = (3 - (ray.origin - view.position).dot(view.forward))
                        / ray.direction.dot(view.forward);
        return ray.origin + t * ray.direction;
    };
    const Vec3f sharp = in_focus(camera_ray(view, 0.4f, -0.7f, 0, 0));
    CHECK((in_focus(camera_ray(view, 0.4f, -0.7f, 1, 0)) - sharp).norm() < 1e-5f);
    CHECK((in_focus(camera_ray(view, 0.4f, -0.7f, -0.3f, 0.9f)) - sharp).norm() < 1e-5f);
}

TEST_CASE("a camera that looks along up or at itself") {
    Options options = explicit_camera();
    options.camera.look_at = {1, 0, 5};  // straight down
    const View view = place_camera(options, {{Vec3f::Zero(), Vec3f::Ones()}});
    CHECK(view.right.norm() == Approx(1));
    CHECK(view.up.norm() == Approx(1));

    options.camera.look_at = options.camera.position;
    try {
        place_camera(options, {{Vec3f::Zero(), Vec3f::Ones()}});
        FAIL("accepted");
    } catch (const assets::Error& error) {
        CHECK(error.kind() == assets::ErrorKind::Input);
        CHECK(error.key() == "camera.look_at");
    }
}
