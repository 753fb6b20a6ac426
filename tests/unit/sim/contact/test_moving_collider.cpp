#include "sim/contact/moving_collider.h"
#include "tests/support/box_file.h"
#include "tests/support/random_fields.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <filesystem>

using sim::Collider;
using sim::ColliderKey;
using sim::MovingCollider;

namespace {

constexpr double quarter_turn = 3.14159265358979323846 / 2;

const assets::Shape shapes[] = {assets::Sphere{{1, 2, 3}, 0.5},
                                assets::Box{{-1, -2, -3}, {1, 2, 3}},
                                assets::Cylinder{{0, 0, 0}, {1, 2, 2}, 0.7},
                                assets::Capsule{{0, 0, 0}, {1, 2, 2}, 0.7},
                                assets::Torus{{0.5, 0, 0}, {1, 1, 0}, 2, 0.5}};

}  // namespace

TEST_CASE("distances are those of the shapes, and normals their gradients") {
    tests::Random random(1);
    for (const assets::Shape& shape : shapes) {
        const MovingCollider collider({shape, {}}, 0.1);
        int checked = 0;
        for (int repeat = 0; repeat < 400; ++repeat) {
            const Vec3 x = tests::random_vector(random, 4);
            const MovingCollider::Distance distance = collider.distance(x);
            CHECK(distance.gap == Approx(assets::signed_distance(shape, x)).margin(1e-12));
            // Where three places around agree on the direction, no edge of the shape lies between.
            constexpr double h = 1e-5;
            const auto slope = [&](double step) {
                Vec3 gradient;
                for (int k = 0; k < 3; ++k)
                    gradient[k] = (assets::signed_distance(shape, x + step * Vec3::Unit(k))
                                   - assets::signed_distance(shape, x - step * Vec3::Unit(k)))
                                  / (2 * step);
                return gradient;
            };
            if ((slope(h) - slope(2 * h)).norm() > 1e-6)
                continue;
            CHECK((distance.normal - slope(h)).norm() < 1e-5);
            ++checked;
        }
        CHECK(checked > 300);
    }
}

TEST_CASE(
    "a shape moves evenly between keys, turns about its centre, and stands still outside") {
    Collider collider{assets::Shape{assets::Box{{0, 0, 0}, {2, 2, 4}}}, {}};
    collider.keys = {{1, {0, 0, 0}, {0, 0, 0}}, {3, {0, 4, 0}, {0, 0, quarter_turn}}};
    const MovingCollider moving(collider, 0.1);
    const Vec3 corner(2, 1, 0);  // one to the right of the centre (1, 1, 2)
    CHECK((moving.pose(0).carry(corner) - corner).norm() < 1e-15);
    CHECK((moving.pose(1).carry(corner) - corner).norm() < 1e-15);
    const double s = std::sqrt(0.5);
    CHECK((moving.pose(2).carry(corner) - Vec3(1 + s, 1 + s + 2, 0)).norm() < 1e-12);
    CHECK((moving.pose(3).carry(corner) - Vec3(1, 2 + 4, 0)).norm() < 1e-12);
    CHECK((moving.pose(9).carry(corner) - Vec3(1, 2 + 4, 0)).norm() < 1e-12);
    CHECK((moving.pose(2).bring_back(moving.pose(2).carry(corner)) - corner).norm() < 1e-14);
}

TEST_CASE("a shape with a pivot turns about it, wherever it lies itself") {
    Collider collider{assets::Shape{assets::Box{{0, 0, 0}, {2, 2, 4}}}, {}};
    collider.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {1, {0, 4, 0}, {0, 0, quarter_turn}}};
    collider.pivot = Vec3(1, 0, 0);
    const MovingCollider moving(collider, 0.1);
    const Vec3 corner(2, 2, 4);
    CHECK((moving.pose(1).carry(corner) - Vec3(-1, 5, 4)).norm() < 1e-14);
    CHECK((moving.pose(1).bring_back({-1, 5, 4}) - corner).norm() < 1e-14);
}

TEST_CASE("ellipsoids and combined shapes are sampled, fine enough for their curvature") {
    constexpr double resolution = 0.1, voxel = resolution / 4, least_radius = 0.36 / 1.2;
    const assets::Shape egg = assets::Ellipsoid{{0, 0, 0}, {1.2, 0.6, 0.8}};
    const assets::Shape two = assets::Combination{
        assets::Combination::Kind::Union, {{egg}, {assets::Sphere{{3, 0, 0}, 0.5}}}, 0};
    tests::Random random(2);
    for (const assets::Shape& shape : {egg, two}) {
        const MovingCollider collider({shape, {}}, resolution);
        int checked = 0;
        for (int repeat = 0; repeat < 4000; ++repeat) {
            const Vec3 x = tests::random_vector(random, 1.3);
            const double gap = assets::signed_distance(shape, x);
            if (std::abs(gap) > voxel)
                continue;
            // A sphere's distance has two curvatures of 1/r, each worth voxel²/(8 r); of quadratic B-splines.
            CHECK(std::abs(collider.distance(x).gap - gap)
                  < voxel * voxel / (4 * (least_radius - 2 * voxel)));
            CHECK(collider.distance(x).normal.norm() == Approx(1).margin(0.02));
            ++checked;
        }
        CHECK(checked > 50);
    }
    CHECK(MovingCollider({two, {}}, resolution).thickness() == Approx(1.2));
}

TEST_CASE("a wall of a mesh has an inside, however coarse the domains") {
    const bool is_inside_out = GENERATE(false, true);
    const auto path = tests::box_file({0, 0, 0}, {0.2, 0.2, 0.004}, is_inside_out);
    const MovingCollider collider({assets::MeshFile{path}, {}}, 0.1);
    CHECK(collider.thickness() <= 0.004);
    CHECK(collider.distance({0.1, 0.1, 0.002}).gap < -0.001);
    for (const double side : {-1.0, 1.0}) {
        const MovingCollider::Distance distance =
            collider.distance({0.1, 0.1, 0.002 + side * 0.003});
        CHECK(distance.gap == Approx(0.001).margin(1e-4));
        CHECK(distance.normal.z() == Approx(side).margin(1e-3));
    }
    std::filesystem::remove(path);
}

TEST_CASE("a collider without a formula that would take too many voxels is refused") {
    const Collider planet{assets::Shape{assets::Ellipsoid{{0, 0, 0}, {60, 50, 40}}}, {}};
    CHECK_THROWS_WITH(MovingCollider(planet, 0.1), Catch::Matchers::Contains("voxels"));
    CHECK_NOTHROW(MovingCollider(planet, 10));
}

TEST_CASE("the thickness is the smallest extent") {
    CHECK(MovingCollider({shapes[1], {}}, 0.1).thickness() == Approx(2));
    CHECK(std::isinf(MovingCollider({sim::PlaneShape{}, {}}, 0.1).thickness()));
}

TEST_CASE("a shape makes all the turns that its keys ask for") {
    Collider collider{assets::Shape{assets::Box{{0, 0, 0}, {2, 2, 4}}}, {}};
    collider.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {1, {0, 0, 0}, {0, 0, 6 * quarter_turn}}};
    const MovingCollider moving(collider, 0.1);
    for (const double time : {0.0, 0.1, 1.0 / 6, 0.5, 0.9, 1.0}) {
        const double angle = 6 * quarter_turn * time;
        const Vec3 expected(1 + std::cos(angle), 1 + std::sin(angle), 0);
        CHECK((moving.pose(time).carry({2, 1, 0}) - expected).norm() < 1e-12);
    }
}
