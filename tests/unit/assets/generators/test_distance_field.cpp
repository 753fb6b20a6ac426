#include "assets/generators/distance_field.h"
#include "tests/support/derivative_order.h"
#include "tests/support/random_fields.h"
#include "tests/unit/assets/generators/obj_file.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using assets::DistanceField;

namespace {

/// No distance at all: every value counts.
struct Rough : assets::Solid {
    Rough() { max = Vec3(1, 0.8, 0.6); }

    double signed_distance(const Vec3& x) const override {
        return std::sin(40 * x.x() + 3) * std::cos(50 * x.y()) + std::sin(60 * x.z() * x.x());
    }
};

/// The quadratic B-spline around 0, of unit knots, and its slope.
double spline(double t) {
    t = std::abs(t);
    return t < 0.5 ? 0.75 - t * t : t < 1.5 ? (1.5 - t) * (1.5 - t) / 2 : 0;
}

double slope(double t) {
    return std::abs(t) < 0.5   ? -2 * t
           : std::abs(t) < 1.5 ? (std::abs(t) - 1.5) * (t > 0 ? 1 : -1)
                               : 0;
}

constexpr double voxel = 0.05;

std::unique_ptr<assets::Solid> solid_of(const assets::Shape& shape) {
    return assets::make_solid({shape, {}}, voxel, 1);
}

}  // namespace

TEST_CASE(
    "a distance field is exact beside flat faces, and a sphere's within curvature voxel²/8") {
    const DistanceField box(*solid_of(assets::Box{{0, 0, 0}, {1, 2, 1}}), voxel);
    Vec3 gradient;
    CHECK(box.at({0.5, 1, 0.93}, gradient) == Approx(-0.07).epsilon(1e-6));
    CHECK((gradient - Vec3::UnitZ()).norm() < 1e-6);
    CHECK(box.at({1.04, 1, 0.5}, gradient) == Approx(0.04).epsilon(1e-5));
    CHECK((gradient - Vec3::UnitX()).norm() < 1e-5);

    const assets::Sphere ball{{1, 2, 3}, 0.4};
    const DistanceField sphere(*solid_of(ball), voxel);
    tests::Random random(3);
    for (int repeat = 0; repeat < 50; ++repeat) {
        const Vec3 n = tests::random_vector(random).normalized();
        // Both principal curvatures, at radius 0.3 and more.
        const double most = 2 / 0.3 * voxel * voxel / 8;
        CHECK(std::abs(sphere.at(ball.center + 0.35 * n, gradient) + 0.05) < most);
        CHECK((gradient - n).norm() < 0.02);
    }
}

TEST_CASE("values and gradients are the sum of products of splines over all of the grid") {
    const Rough solid;
    const DistanceField field(solid, voxel);
    const Vec3 low = Vec3::Constant(-2 * voxel);
    tests::Random random(6);
    for (int repeat = 0; repeat < 20; ++repeat) {
        const Vec3 x(tests::between(random, 0, 1),
                     tests::between(random, 0, 0.8),
                     tests::between(random, 0, 0.6));
        double value = 0;
        Vec3 expected = Vec3::Zero(), gradient;
        for (int k = 0; k < 18; ++k)
            for (int j = 0; j < 22; ++j)
                for (int i = 0; i < 26; ++i) {
                    const Vec3 node(i, j, k), t = (x - low) / voxel - node,
                                              w = t.unaryExpr(&spline), d = t.unaryExpr(&slope);
                    const double there =
                        static_cast<float>(solid.signed_distance(low + voxel * node));
                    value += there * w.prod();
                    expected +=
                        there / voxel
                        * Vec3(d[0] * w[1] * w[2], w[0] * d[1] * w[2], w[0] * w[1] * d[2]);
                }
        CHECK(field.at(x, gradient) == Approx(value).margin(1e-12));
        CHECK((gradient - expected).norm() < 1e-12 / voxel);
    }
}

TEST_CASE(
    "the gradient of a distance field is its derivative, also where distances have edges") {
    const DistanceField box(*solid_of(assets::Box{{0, 0, 0}, {1, 1, 1}}), voxel);
    tests::Random random(4);
    for (int repeat = 0; repeat < 50; ++repeat) {
        const Vec3 x = Vec3::Constant(0.5) + tests::random_vector(random, 0.5);
        const Vec3 direction = tests::random_vector(random).normalized();
        Vec3 gradient, ignored;
        box.at(x, gradient);
        constexpr double h = 1e-5;
        const double difference =
            (box.at(x + h * direction, ignored) - box.at(x - h * direction, ignored)) / (2 * h);
        // A second derivative may jump between the two: at most 2 / voxel, times h.
        CHECK(std::abs(difference - gradient.dot(direction)) < 4 * h / voxel);
    }
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Along rays from `centre`, in the solid, to far outside of the grid; `exact` is the distance, which the solid tells up
/// to `band`.
template <class Exact>
void check_rays(const DistanceField& field,
                const Vec3& centre,
                double margin,
                double band,
                const Exact& exact) {
    // Of distances whose two curvatures are 1/voxel at most, as a voxel from an edge or a corner.
    constexpr double interpolation_error = 2 / voxel * voxel * voxel / 8;
    constexpr double step = voxel / 3;
    tests::Random random(5);
    for (int ray = 0; ray < 24; ++ray) {
        // A third goes along the axes and the diagonals, through faces, edges and corners of the grid.
        Vec3 direction = tests::random_vector(random);
        if (ray % 3 == 0)
            direction = direction.array().round().matrix();
        if (!(direction.norm() > 0))
            continue;
        direction.normalize();
        Vec3 gradient;
        double before = field.at(centre, gradient);
        for (double r = step; r < 2; r += step) {
            const Vec3 x = centre + r * direction;
            const double distance = field.at(x, gradient), truth = exact(x);
            CAPTURE(x.transpose(), distance, truth);
            REQUIRE(std::abs(distance - before) <= 2 * step);
            if (truth > -voxel)
                REQUIRE(distance <= truth + interpolation_error);
            if (truth > voxel)
                REQUIRE(distance >= 0.7 * std::min(truth, band) - interpolation_error);
            if (truth > -voxel && truth < margin + voxel)
                REQUIRE(std::abs(distance - truth) <= interpolation_error);
            before = distance;
        }
    }
}

}  // namespace

TEST_CASE("where its grid ends a distance field goes on, and tells no more than the distance") {
    const double margin = GENERATE(0.0, 0.33);
    const assets::Shape shapes[] = {assets::Box{{-1, -0.5, -0.2}, {1, 0.5, 0.2}},
                                    assets::Sphere{{0, 0, 0}, 0.6}};
    for (const assets::Shape& shape : shapes) {
        const auto exact = [&](const Vec3& x) { return assets::signed_distance(shape, x); };
        check_rays(
            DistanceField(*solid_of(shape), voxel, margin), {0, 0, 0}, margin, infinity, exact);

        const ObjFile file("supple_field", assets::make_surface({shape, {}}, voxel).mesh);
        constexpr double band = 0.7;
        const auto solid = assets::make_solid(file.source(), voxel, band);
        check_rays(DistanceField(*solid, voxel, margin), {0, 0, 0}, margin, band, exact);
    }
}
