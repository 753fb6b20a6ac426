#include "render/pathtrace/path_tracer.h"
#include "tests/unit/render/meshes.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <array>
#include <cmath>

using namespace render;
using namespace render::testing;

namespace {

const RectangleLight lamp{{0.3f, 2.0f, -0.2f}, {0.6f, 0.1f, 0}, {0, 0.1f, 0.5f}, {3, 2, 1}};

// Irradiance of a polygon of radiance 1 on a point with normal n: 1/2 Σ angle_k · (edge plane's normal · n)
// [Lambert 1760]. All corners must lie above the horizon.
double polygon_irradiance(const std::array<Vec3, 4>& corners,
                          const Vec3& point,
                          const Vec3& n) {
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
        const Vec3 a = (corners[k] - point).normalized(),
                   b = (corners[(k + 1) % 4] - point).normalized();
        sum += std::acos(a.dot(b)) * a.cross(b).normalized().dot(n);
    }
    return std::abs(sum) / 2;
}

double lamp_irradiance(const Vec3& point) {
    const Vec3 c = lamp.center.cast<double>(), u = lamp.half_u.cast<double>(),
               v = lamp.half_v.cast<double>();
    return polygon_irradiance(
        {c - u - v, c + u - v, c + u + v, c - u + v}, point, Vec3::UnitY());
}

RectangleLight facing_down(RectangleLight light) {
    if (light.half_u.cross(light.half_v).y() > 0)
        light.half_u = -light.half_u;
    return light;
}

// A camera so narrow that its one pixel sees a point of the ground.
View at_point(const Vec3f& point) {
    View view;
    view.position = point + Vec3f(0, 1, 0);
    view.right = Vec3f::UnitX();
    view.up = -Vec3f::UnitZ();
    view.forward = -Vec3f::UnitY();
    view.tan_half_width = view.tan_half_height = 1e-4f;
    return view;
}

struct Estimate {
    double mean, sigma;
};

// Green channel at a point from many independent sequences.
Estimate radiance_at(const Scene& scene, const Vec3f& point, LightSampling how, int samples) {
    constexpr int n = 48;
    TraceOptions options;
    options.width = options.height = 1;
    options.samples = samples;
    options.path.light_sampling = how;
    double sum = 0, sum_squares = 0;
    for (int i = 0; i < n; ++i) {
        options.seed = std::uint32_t(i);
        const double value = trace(scene, at_point(point), options).pixels[0].y();
        sum += value, sum_squares += value * value;
    }
    const double mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, sum_squares / n - mean * mean) / (n - 1))};
}

}  // namespace

TEST_CASE("a rectangle lights a plane as the polygon formula says") {
    constexpr float albedo = 0.6f;
    Scene scene = furnace(0);
    scene.lights.push_back(facing_down(lamp));
    scene.meshes.push_back(ground(0, 10, Vec3f::Constant(albedo)));
    for (const Vec3f& point : {Vec3f(0, 0, 0), Vec3f(1.5f, 0, 0.7f), Vec3f(-1, 0, -1.5f)}) {
        const double expected =
            albedo / M_PI * lamp.radiance.y() * lamp_irradiance(point.cast<double>());
        for (const LightSampling how :
             {LightSampling::Both, LightSampling::LightsAlone, LightSampling::SurfacesAlone}) {
            const auto [mean, sigma] = radiance_at(scene, point, how, 256);
            CAPTURE(point.transpose(), int(how), mean, expected, sigma);
            CHECK(sigma < 0.06 * expected);
            CHECK(std::abs(mean - expected) < 3 * sigma + 1e-4 * expected);
        }
    }
}

TEST_CASE(
    "light and surface sampling agree with two lights, gloss and a clear body on the way") {
    Scene scene = furnace(0.2f);
    scene.lights = {facing_down(lamp),
                    {{-1.5f, 1.5f, 0.5f}, {0, 0.4f, 0}, {0.2f, 0, 0.5f}, {2, 4, 6}}};
    scene.meshes.push_back(ground(0, 10, Vec3f::Constant(0.5f)));
    scene.meshes[0].material.coated = true;
    scene.meshes[0].material.roughness = 0.6f;
    Material gel;
    gel.opacity = 0.2f;
    gel.roughness = 0.6f;
    gel.absorption = {0.2f, 0.5f, 1.0f};
    scene.meshes.push_back(sphere({0.1f, 0.6f, 0}, 0.4f, Vec3f::Constant(0.8f), gel));
    const Vec3f point(0.15f, 0, 0.1f);
    const auto both = radiance_at(scene, point, LightSampling::Both, 128);
    for (const LightSampling how : {LightSampling::LightsAlone, LightSampling::SurfacesAlone}) {
        const auto other = radiance_at(scene, point, how, 512);
        CAPTURE(int(how), both.mean, both.sigma, other.mean, other.sigma);
        CHECK(other.sigma < 0.03 * both.mean);
        CHECK(std::abs(both.mean - other.mean) < 3 * std::hypot(both.sigma, other.sigma));
    }
}

TEST_CASE("shadow rays stop at opaque bodies and are tinted by clear ones") {
    constexpr float radius = 0.5f, opacity = 0.3f;
    Scene scene = furnace(0);
    Material gel = matt();
    gel.opacity = opacity;
    gel.absorption = {0, 1, 2};
    scene.meshes.push_back(sphere(Vec3f::Zero(), radius, Vec3f::Ones(), gel));
    const EmbreeScene rays(scene);
    // Slightly off the axis: Embree would count an edge of the sphere's mesh twice.
    const Vec3f start(0.003f, -2, 0.001f);
    const auto expected = [&](int n_skins, float way) -> Vec3f {
        return std::pow(1 - opacity, float(n_skins)) * (-way * gel.absorption).array().exp();
    };
    const float slack = 5e-3f;  // the facets of the sphere
    CHECK((rays.transmittance({start, Vec3f::UnitY()}, 4) - expected(2, 2 * radius)).norm()
          < slack);
    CHECK((rays.transmittance({start + 2 * Vec3f::UnitY(), Vec3f::UnitY()}, 4)
           - expected(1, radius))
              .norm()
          < slack);
    CHECK(rays.transmittance({start, Vec3f::UnitY()}, 1) == Vec3f(Vec3f::Ones()));

    scene.meshes.push_back(sphere(Vec3f::Zero(), 0.2f, Vec3f::Ones(), matt()));
    CHECK(EmbreeScene(scene).transmittance({start, Vec3f::UnitY()}, 4) == Vec3f(Vec3f::Zero()));
}

TEST_CASE("lights shine to one side") {
    Scene scene = furnace(0);
    RectangleLight up = facing_down(lamp);
    up.half_u = -up.half_u;
    scene.lights.push_back(up);
    scene.meshes.push_back(ground(0, 10, Vec3f::Ones()));
    CHECK(radiance_at(scene, Vec3f::Zero(), LightSampling::Both, 16).mean == 0);
}
