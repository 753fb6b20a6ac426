#include "assets/base/error.h"
#include "sim/embedding/embedding.h"
#include "tests/unit/sim/lattice/bodies.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <cmath>

using namespace sim;

namespace {

constexpr float single_rounding = 1e-6f;

Body two_coloured_bar() {
    Body bar = body(assets::Box{{0, 0, 0}, {4, 1, 1}}, 0.5);
    bar.regions.push_back(region("soft", between(2, 9)));
    bar.regions[0].color = {1, 0, 0};
    bar.regions[1].color = {0.5f, 0.02f, 0};
    return bar;
}

std::vector<Vec3> moved(const Lattice& lattice, const Mat3& A, const Vec3& b) {
    std::vector<Vec3> corners;
    for (const Vec3& X : lattice.corner_rest)
        corners.push_back(A * X + b);
    return corners;
}

}  // namespace

TEST_CASE("at rest a surface is its source, unstretched") {
    const Body ball = body(assets::Sphere{{0, 0, 0}, 1}, 0.25);
    const Lattice lattice = make_lattice(ball);
    const EmbeddedSurface surface(lattice, ball, {"outside", {}});
    const assets::SurfaceFrame frame = surface.deformed(lattice, lattice.corner_rest, {});
    const assets::CachedSurface& cached = surface.cached();
    CHECK(cached.body == "b");
    CHECK(cached.skin == "outside");
    REQUIRE(frame.positions.size() == cached.rest_positions.size());
    CHECK(frame.attributes.count("enriched") == 0);
    for (std::size_t v = 0; v < frame.positions.size(); ++v) {
        CHECK((frame.positions[v] - cached.rest_positions[v]).norm() < single_rounding);
        CHECK(frame.positions[v].norm() == Approx(1).epsilon(1e-5));
        CHECK(frame.attributes.at("stretch")[v] == Approx(1).epsilon(1e-5));
    }
}

TEST_CASE("an affine motion moves positions, normals and stretch as theory says") {
    const Body bar = two_coloured_bar();
    const Lattice lattice = make_lattice(bar);
    const EmbeddedSurface surface(lattice, bar, {"outside", {}});
    Mat3 A;
    A << 1.5, 0.3, 0, -0.1, 0.8, 0.2, 0, 0.4, 1.1;
    const Vec3 b(1, 2, 3);
    const assets::SurfaceFrame rest = surface.deformed(lattice, lattice.corner_rest, {});
    const assets::SurfaceFrame frame = surface.deformed(lattice, moved(lattice, A, b), {});
    // The largest stretch is the norm of A: power iteration on A^T A.
    Vec3 v = Vec3::Ones();
    for (int i = 0; i < 200; ++i)
        v = (A.transpose() * A * v).normalized();
    const Mat3 inverse_transposed = A.inverse().transpose();
    for (std::size_t i = 0; i < frame.positions.size(); ++i) {
        const Vec3 X = rest.positions[i].cast<double>(), n = rest.normals[i].cast<double>();
        CHECK((frame.positions[i].cast<double>() - A * X - b).norm() < 10 * single_rounding);
        CHECK((frame.normals[i].cast<double>() - (inverse_transposed * n).normalized()).norm()
              < single_rounding);
        CHECK(frame.attributes.at("stretch")[i] == Approx((A * v).norm()).epsilon(1e-5));
    }
}

TEST_CASE("the stretch is right where principal stretches coincide") {
    const Body bar = two_coloured_bar();
    const Lattice lattice = make_lattice(bar);
    const EmbeddedSurface surface(lattice, bar, {"outside", {}});
    for (const Vec3& stretches :
         {Vec3(2, 2, 2), Vec3(2, 2, 0.5), Vec3(0.5, 2, 0.5), Vec3(0, 0, 0), Vec3(2, 0, -1)}) {
        const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
        const auto frame = surface.deformed(
            lattice, moved(lattice, R * stretches.asDiagonal(), Vec3::Zero()), {});
        for (std::size_t v = 0; v < frame.positions.size(); ++v) {
            CHECK(frame.attributes.at("stretch")[v]
                  == Approx(stretches.cwiseAbs().maxCoeff()).margin(1e-6));
            CHECK(frame.normals[v].norm() == Approx(1));  // flattened corners too
        }
    }
}

TEST_CASE("vertices know their region and its linear colour") {
    const Body bar = two_coloured_bar();
    const Lattice lattice = make_lattice(bar);
    const EmbeddedSurface surface(lattice, bar, {"outside", {}});
    const auto frame = surface.deformed(
        lattice, lattice.corner_rest, std::vector<char>(lattice.n_domains(), 1));
    for (std::size_t v = 0; v < frame.positions.size(); ++v) {
        const float x = surface.cached().rest_positions[v].x();
        if (std::abs(x - 2) < 0.01f)
            continue;
        CHECK(frame.attributes.at("region")[v] == (x > 2 ? 1 : 0));
        // sRGB 0.5 is 0.21404 linear; below 0.04045 the curve is straight, of slope 1 / 12.92.
        const Vec3f color = x > 2 ? Vec3f(0.21404f, 0.02f / 12.92f, 0) : Vec3f(1, 0, 0);
        CHECK((surface.cached().region_color[v] - color).norm() < 1e-5f);
        CHECK(frame.attributes.at("enriched")[v] == 1);
    }
}

TEST_CASE("an inner part is a skin in the region that it bounds") {
    Body cube = body(assets::Box{{0, 0, 0}, {1, 1, 1}}, 0.1);
    const assets::Sphere ball{{0.5, 0.5, 0.5}, 0.3};
    cube.regions.push_back(region("core", {ball, {}}));
    const Lattice lattice = make_lattice(cube);
    const EmbeddedSurface surface(
        lattice, cube, {"core", assets::Source{assets::Shape(ball), {}}});
    const auto frame = surface.deformed(lattice, lattice.corner_rest, {});
    REQUIRE(frame.positions.size() > 1000);
    for (std::size_t v = 0; v < frame.positions.size(); ++v) {
        CHECK(frame.attributes.at("region")[v] == 1);
        CHECK((frame.positions[v].cast<double>() - ball.center).norm()
              == Approx(0.3).epsilon(1e-5));
    }
}

TEST_CASE("a skin far from its body is an error") {
    const Body bar = two_coloured_bar();
    const Lattice lattice = make_lattice(bar);
    try {
        const EmbeddedSurface surface(
            lattice,
            bar,
            {"core", assets::Source{assets::Shape(assets::Sphere{{90, 0, 0}, 1}), {}}});
        FAIL("no error");
    } catch (const assets::Error& error) {
        CHECK(error.key() == "body.b.skin.core");
        CHECK_THAT(error.what(), Catch::Contains("outside body \"b\""));
    }
}

TEST_CASE("deformed surfaces are the same for any number of threads") {
    const Body ball = body(assets::Sphere{{0, 0, 0}, 1}, 0.1);
    const Lattice lattice = make_lattice(ball);
    const EmbeddedSurface surface(lattice, ball, {"outside", {}});
    std::vector<Vec3> corners;
    for (const Vec3& X : lattice.corner_rest)
        corners.push_back(X + 0.02 * Vec3::Random());
    const auto with_all = surface.deformed(lattice, corners, {});
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto with_one = surface.deformed(lattice, corners, {});
    CHECK(with_all.positions == with_one.positions);
    CHECK(with_all.normals == with_one.normals);
    CHECK(with_all.attributes == with_one.attributes);
}
