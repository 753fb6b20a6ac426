#include "assets/generators/distance_field.h"
#include "tests/support/derivative_order.h"
#include "tests/support/random_fields.h"

#include <catch2/catch.hpp>

using assets::DistanceField;

namespace {

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
        const double most =
            2 / 0.3 * voxel * voxel / 8;  // both principal curvatures, at radius 0.3 and more
        CHECK(std::abs(sphere.at(ball.center + 0.35 * n, gradient) + 0.05) < most);
        CHECK((gradient - n).norm() < 0.02);
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

TEST_CASE("far outside a distance field tells a distance that is no longer than the true one") {
    const DistanceField box(*solid_of(assets::Box{{0, 0, 0}, {1, 1, 1}}), voxel);
    Vec3 gradient;
    const double distance = box.at({3, 0.5, 0.5}, gradient);
    CHECK(distance > 1.5);
    CHECK(distance <= 2);
    CHECK((gradient - Vec3::UnitX()).norm() < 1e-12);
}
