#include "render/pathtrace/path_tracer.h"
#include "tests/unit/render/meshes.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace render;
using namespace render::testing;

namespace {

View looking_down_z(float tan_half_size, float distance) {
    View view;
    view.position = {0, 0, distance};
    view.right = Vec3f::UnitX();
    view.up = Vec3f::UnitY();
    view.forward = -Vec3f::UnitZ();
    view.tan_half_width = view.tan_half_height = tan_half_size;
    return view;
}

double largest_deviation(const Image& image, double expected) {
    double largest = 0;
    for (const Vec3f& pixel : image.pixels)
        largest = std::max(largest, double((pixel.array() - float(expected)).abs().maxCoeff()));
    return largest;
}

TraceOptions small(int samples) {
    TraceOptions options;
    options.width = options.height = 16;
    options.samples = samples;
    options.path.max_bounces = 60;
    return options;
}

}  // namespace

TEST_CASE("a matt sphere under a uniform sky shows its albedo") {
    Scene scene = furnace();
    scene.meshes.push_back(sphere(Vec3f::Zero(), 1, {0.25f, 0.5f, 0.75f}, matt()));
    // The picture lies inside the sphere.
    const Image image = trace(scene, looking_down_z(0.15f, 4), small(4));
    for (const Vec3f& pixel : image.pixels)
        CHECK((pixel - Vec3f(0.25f, 0.5f, 0.75f)).norm() < 1e-5f);
}

TEST_CASE("white things vanish in a white furnace, however often light bounces between them") {
    Scene scene = furnace();
    scene.meshes.push_back(sphere({-0.9f, 0, 0}, 0.8f, Vec3f::Ones(), matt()));
    scene.meshes.push_back(sphere({0.9f, 0, 0}, 0.8f, Vec3f::Ones(), matt()));
    scene.meshes.push_back(ground(-0.9f, 5, Vec3f::Ones()));
    CHECK(largest_deviation(trace(scene, looking_down_z(0.5f, 4), small(8)), 1) < 1e-4);
}

TEST_CASE("a clear white body without absorption vanishes in a white furnace") {
    Scene scene = furnace();
    Material clear = matt();
    clear.opacity = 0.4f;
    scene.meshes.push_back(sphere(Vec3f::Zero(), 1, Vec3f::Ones(), clear));
    scene.meshes.push_back(sphere(Vec3f::Zero(), 0.4f, Vec3f::Ones(), matt()));
    CHECK(largest_deviation(trace(scene, looking_down_z(0.3f, 4), small(8)), 1) < 1e-4);
}

TEST_CASE("coated bodies in a white furnace keep the energy in the mean") {
    for (const float opacity : {1.0f, 0.3f}) {
        Scene scene = furnace();
        Material coated;
        coated.roughness = 0.5f;
        coated.opacity = opacity;
        scene.meshes.push_back(sphere(Vec3f::Zero(), 1, Vec3f::Ones(), coated));
        const Image image = trace(scene, looking_down_z(0.2f, 4), small(256));
        Vec3f mean = Vec3f::Zero();
        for (const Vec3f& pixel : image.pixels)
            mean += pixel / float(image.pixels.size());
        CHECK(mean.x() == Approx(1).margin(0.005));
    }
}

TEST_CASE("an integrating sphere with an opening has the radiance of theory") {
    // Inside of a sphere every wall element receives from every other alike (form factor = area share). With albedo
    // a and open share f under a sky of radiance 1: B = a ((1 - f) B + f), so B = a f / (1 - a (1 - f)).
    constexpr float albedo = 0.8f, cut = 0.5f;
    constexpr double open = (1 - cut) / 2;
    constexpr double expected = albedo * open / (1 - albedo * (1 - open));
    Scene scene = furnace();
    scene.meshes.push_back(sphere(Vec3f::Zero(), 1, Vec3f::Constant(albedo), matt(), cut));
    const Image image = trace(
        scene, looking_down_z(0.1f, 3), small(256));  // through the opening, at the bottom
    double sum = 0, sum_squares = 0;
    for (const Vec3f& pixel : image.pixels)
        sum += pixel.x(), sum_squares += double(pixel.x()) * pixel.x();
    const double n = double(image.pixels.size()), mean = sum / n;
    const double sigma = std::sqrt((sum_squares / n - mean * mean) / n);
    CAPTURE(mean, expected, sigma);
    CHECK(sigma < 0.005 * expected);
    CHECK(std::abs(mean - expected)
          < 3 * sigma + 0.003 * expected);  // and 0.3 % for the sphere's facets
}

TEST_CASE("the inside of a clear body follows Beer's law") {
    Scene scene = furnace();
    Material clear = matt();
    clear.opacity = 0;
    clear.absorption = {0.5f, 1.0f, 2.0f};
    scene.meshes.push_back(sphere(Vec3f::Zero(), 1, Vec3f::Ones(), clear));
    // Along the diameter of 2 m.
    const Image image = trace(scene, looking_down_z(1e-3f, 4), small(1));
    const Vec3f& pixel = image.pixels[0];
    CHECK(pixel.x() == Approx(std::exp(-1.0)).epsilon(5e-3));
    CHECK(pixel.y() == Approx(std::exp(-2.0)).epsilon(5e-3));
    CHECK(pixel.z() == Approx(std::exp(-4.0)).epsilon(5e-3));
}
