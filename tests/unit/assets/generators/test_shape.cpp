#include "assets/generators/solid.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace assets;

namespace {

constexpr double rounding = 1e-12;  // of shapes of about a metre

const std::vector<Shape> shapes = {Box{{-1, 0.5, 0}, {0.5, 2, 0.25}},
                                   Sphere{{0.3, -0.2, 0.1}, 0.7},
                                   Cylinder{{0, 0, 0}, {1, 2, 0.5}, 0.4},
                                   Capsule{{0.2, 0, 0}, {0.2, -1, 1}, 0.3},
                                   Torus{{0, 0.1, 0}, {1, 1, 3}, 0.8, 0.25},
                                   Ellipsoid{{0.2, 0, -0.1}, {1.1, 0.3, 0.7}}};

const Shape ball = Sphere{{0.3, -0.2, 0.1}, 0.7},
            block = Box{{-1, -0.4, -0.5}, {0.6, 0.4, 0.9}},
            rod = Capsule{{-1, 0.5, 0}, {1, -0.3, 0.4}, 0.3};

Combination combined(Combination::Kind kind, double smooth) {
    return {kind, {{ball}, {block}, {rod}}, smooth};
}

/// Combinations and copies, with and without fillets, also of each other.
std::vector<Shape> composed() {
    using Kind = Combination::Kind;
    std::vector<Shape> of;
    for (const double smooth : {0.0, 0.3})
        for (const Kind kind : {Kind::Union, Kind::Intersection, Kind::Difference})
            of.push_back(combined(kind, smooth));
    of.push_back(moved(block, {0.3, -0.5, 1}, {0.2, 0.1, -0.3}));
    of.push_back(mirrored(rod, {0.2, 0, 0}, {1, 2, 0}));
    of.push_back(ring_of(Ellipsoid{{1, 0, 0}, {0.6, 0.1, 0.3}}, {0.1, 0, 0}, {0, 0, 2}, 5));
    of.push_back(Combination{Kind::Union, {{of[4]}, {of.back()}}, 0.2});
    return of;
}

Vec3 random_point(std::mt19937& random) {
    std::uniform_real_distribution<double> coordinate(-2.5, 2.5);
    return {coordinate(random), coordinate(random), coordinate(random)};
}

Vec3 gradient(const Shape& shape, const Vec3& x) {
    constexpr double h = 1e-6;
    Vec3 g;
    for (int i = 0; i < 3; ++i)
        g[i] = (signed_distance(shape, x + h * Vec3::Unit(i))
                - signed_distance(shape, x - h * Vec3::Unit(i)))
               / (2 * h);
    return g;
}

}  // namespace

TEST_CASE("signed distances at points where they are known") {
    CHECK(signed_distance(Box{{0, 0, 0}, {2, 2, 2}}, {1, 1, 0.25}) == Approx(-0.25));
    CHECK(signed_distance(Box{{0, 0, 0}, {2, 2, 2}}, {5, 6, 1}) == Approx(5));
    CHECK(signed_distance(Sphere{{1, 0, 0}, 2}, {1, 0, 5}) == Approx(3));
    const Cylinder cylinder{{0, 0, 0}, {0, 0, 4}, 1};
    CHECK(signed_distance(cylinder, {0, 0.75, 2}) == Approx(-0.25));
    CHECK(signed_distance(cylinder, {0, 0, 3.5}) == Approx(-0.5));
    CHECK(signed_distance(cylinder, {0, 4, 8}) == Approx(5));
    CHECK(signed_distance(Capsule{{0, 0, 0}, {0, 0, 4}, 1}, {0, 3, 8}) == Approx(4));
    CHECK(signed_distance(Capsule{{0, 0, 0}, {0, 0, 0}, 1}, {0, 3, 0}) == Approx(2));
    CHECK(signed_distance(Torus{{0, 0, 0}, {0, 0, 2}, 2, 0.5}, {2, 0, 0}) == Approx(-0.5));
    CHECK(signed_distance(Torus{{0, 0, 0}, {0, 0, 2}, 2, 0.5}, {0, 0, 0}) == Approx(1.5));
}

TEST_CASE("a signed distance leads to the surface along its gradient") {
    std::mt19937 random(1);
    for (const Shape& shape : shapes)
        for (int i = 0; i < 200; ++i) {
            const Vec3 x = random_point(random);
            const double distance = signed_distance(shape, x);
            if (distance < 0.01)  // inside, gradients jump at the medial surface
                continue;
            const Vec3 on_surface = x - distance * gradient(shape, x);
            CHECK(std::abs(signed_distance(shape, on_surface))
                  < 1e-7);  // rounding / step of the gradient
        }
}

TEST_CASE("the support function bounds the points inside, tightly") {
    std::mt19937 random(2);
    for (const Shape& shape : shapes) {
        const Vec3 direction = random_point(random).normalized();
        const double bound = support(shape, direction);
        for (int i = 0; i < 2000; ++i) {
            const Vec3 x = random_point(random);
            if (signed_distance(shape, x) <= 0)
                CHECK(direction.dot(x) <= bound + rounding);
        }
        // A plane just beyond the bound misses the shape, one through it touches: seen from far away along the
        // direction, the distance to the shape's plane is the distance to the shape plus the sagitta.
        double nearest = 1e9;
        for (int i = 0; i < 40000; ++i) {
            const Vec3 x = random_point(random);
            const Vec3 on_plane = x - (direction.dot(x) - bound) * direction;
            nearest = std::min(nearest, signed_distance(shape, on_plane));
        }
        CHECK(nearest > -rounding);
        CHECK(nearest < 0.01);  // the closest of 40000 points in a square of 5 m
    }
}

TEST_CASE("the distance to an ellipsoid is that of its nearest point") {
    const Ellipsoid ellipsoid{{0.2, 0, -0.1}, {1.1, 0.3, 0.7}};
    CHECK(signed_distance(ellipsoid, ellipsoid.center) == Approx(-0.3));
    CHECK(signed_distance(ellipsoid, {0.2, 2.3, -0.1}) == Approx(2));
    CHECK(signed_distance(ellipsoid, {3.3, 0, -0.1}) == Approx(2));
    // Within the evolute the nearest points lie off the axis: at x from the centre of an ellipse of radii a > b
    // they are at a² x / (a² - b²), and the distance is b sqrt(1 - x² / (a² - b²)).
    const double squares = 1.21 - 0.09;
    CHECK(signed_distance(ellipsoid, {0.2 + 0.5, 0, -0.1})
          == Approx(-0.3 * std::sqrt(1 - 0.25 / squares)));
    CHECK(signed_distance(Ellipsoid{{0, 0, 0}, {2, 2, 2}}, {1, 2, 2}) == Approx(1));
}

TEST_CASE("combinations are sets of points: either, all, the first without the others") {
    std::mt19937 random(3);
    const auto holds = [](const Shape& shape, const Vec3& x) {
        return signed_distance(shape, x) < 0;
    };
    int n_inside[3] = {};
    for (int i = 0; i < 4000; ++i) {
        const Vec3 x = 0.5 * random_point(random);
        const bool in_ball = holds(ball, x), in_block = holds(block, x), in_rod = holds(rod, x);
        const bool expected[] = {in_ball || in_block || in_rod,
                                 in_ball && in_block && in_rod,
                                 in_ball && !in_block && !in_rod};
        for (int k = 0; k < 3; ++k) {
            CHECK(holds(combined(static_cast<Combination::Kind>(k), 0), x) == expected[k]);
            n_inside[k] += expected[k];
        }
    }
    CHECK(*std::min_element(n_inside, n_inside + 3) > 20);
}

TEST_CASE("the distance of a combination is never more than the true one") {
    std::mt19937 random(4);
    for (const Shape& shape : composed())
        for (int i = 0; i < 1000; ++i) {  // a slope of 1 at most says so
            const Vec3 x = random_point(random), y = random_point(random);
            CHECK(std::abs(signed_distance(shape, x) - signed_distance(shape, y))
                  <= (x - y).norm() + rounding);
        }
    // Where one surface alone is near it is the distance.
    const Shape apart =
        Combination{Combination::Kind::Union, {{ball}, {Sphere{{3, 0, 0}, 0.5}}}, 0.1};
    CHECK(signed_distance(apart, {4, 0, 0}) == Approx(0.5));
}

TEST_CASE("bounds contain what is combined, copied and filleted") {
    std::mt19937 random(5);
    for (const Shape& shape : composed())
        for (int i = 0; i < 2000; ++i) {
            const Vec3 x = random_point(random), direction = random_point(random).normalized();
            CHECK(signed_distance(shape, x)
                  >= direction.dot(x) - support(shape, direction) - rounding);
        }
}

TEST_CASE("a fillet fills a corner by a quarter of its size, and nothing else") {
    const Shape floor = Box{{-9, -9, -9}, {9, 9, 0}}, wall = Box{{-9, -9, -9}, {0, 9, 9}};
    using Kind = Combination::Kind;
    const auto at = [&](Kind kind, const Vec3& x) {
        return signed_distance(Combination{kind, {{floor}, {wall}}, 0.4}, x);
    };
    CHECK(at(Kind::Union, {0.1, 0, 0.1}) == Approx(0).margin(rounding));  // 0.1 = 0.4 / 4
    CHECK(at(Kind::Union, {0.5, 0, 0.1}) == Approx(0.1));                 // 0.5 - 0.1 = 0.4
    CHECK(at(Kind::Intersection, {-0.1, 0, -0.1}) == Approx(0).margin(rounding));
    CHECK(at(Kind::Intersection, {-0.5, 0, -0.1}) == Approx(-0.1));
    CHECK(at(Kind::Difference, {0.1, 0, -0.1}) == Approx(0).margin(rounding));
    CHECK(at(Kind::Difference, {0.1, 0, -0.5}) == Approx(-0.1));
}

TEST_CASE("copies lie where they are put") {
    std::mt19937 random(6);
    const Vec3 rotate(0.3, -0.5, 1), translate(0.2, 0.1, -0.3), point(0.2, 0.3, 0);
    const Shape there = moved(block, rotate, translate);
    const Shape pair = mirrored(block, {2, 0, 0}, {3, 0, 0});
    const Shape quarters = ring_of(block, point, {0, 0, 2}, 4);
    for (int i = 0; i < 200; ++i) {
        const Vec3 x = random_point(random);
        const double distance = signed_distance(block, x);
        CHECK(signed_distance(there, rotation(rotate) * x + translate)
              == Approx(distance).margin(rounding));
        CHECK(signed_distance(pair, {4 - x.x(), x.y(), x.z()})
              == Approx(signed_distance(pair, x)).margin(rounding));
        const Vec3 turned = point + Vec3(point.y() - x.y(), x.x() - point.x(), x.z());
        CHECK(signed_distance(quarters, turned)
              == Approx(signed_distance(quarters, x)).margin(rounding));
        CHECK(signed_distance(quarters, x) <= distance);
    }
    CHECK(signed_distance(pair, {4, 0, 0}) == Approx(signed_distance(block, {0, 0, 0})));
}

TEST_CASE("transforms scale, rotate about x, y, z in this order, and translate") {
    const double right_angle = std::acos(0.0);
    const Transform transform{2, {right_angle, 0, right_angle}, {1, 2, 3}};
    // y -> (about x) z -> (about z) z; scaled by 2
    CHECK((apply(transform, {0, 1, 0}) - Vec3(1, 2, 5)).norm() < rounding);
    // z -> (about x) -y -> (about z) x
    CHECK((apply(transform, {0, 0, 1}) - Vec3(3, 2, 3)).norm() < rounding);
}

TEST_CASE("the solid of a moved shape has moved distances and exact bounds") {
    const double eighth_turn = std::acos(0.0) / 2;
    const auto solid = make_solid(
        {Shape(Box{{-1, -1, -1}, {1, 1, 1}}), {3, {0, 0, eighth_turn}, {10, 0, 0}}}, 0.1, 1);
    const double half_diagonal = 3 * std::sqrt(2.0);
    CHECK((solid->min - Vec3(10 - half_diagonal, -half_diagonal, -3)).norm() < 10 * rounding);
    CHECK((solid->max - Vec3(10 + half_diagonal, half_diagonal, 3)).norm() < 10 * rounding);
    CHECK(solid->signed_distance({10, 0, 5}) == Approx(2));
    CHECK(solid->signed_distance({10 + half_diagonal + 1, 0, 0}) == Approx(1));
    CHECK(solid->signed_distance({10, 0, 0}) == Approx(-3));
}

TEST_CASE("a shape without volume is refused") {
    CHECK_THROWS_WITH(make_solid({Shape(Sphere{{0, 0, 0}, 0}), {}}, 0.1, 1),
                      Catch::Contains("no volume"));
}

TEST_CASE("what a combination skips of its parts does not change its distance") {
    using Kind = Combination::Kind;
    std::vector<Shape> parts;
    for (int i = 0; i < 4; ++i)
        parts.push_back(moved(Ellipsoid{{0.4 * i, 0, 0.1}, {0.9, 0.2 + 0.1 * i, 0.4}},
                              {0.5 * i, 0, 1.0 * i},
                              {0, 0.3 * i, 0}));
    const Shape ring = ring_of(parts[1], {0, 0, 0}, {0, 0, 1}, 3);
    std::mt19937 random(7);
    for (const double smooth : {0.0, 0.5})
        for (const Kind kind : {Kind::Union, Kind::Intersection, Kind::Difference}) {
            Combination inner{kind, {{parts[0]}, {parts[1]}, {ring}}, smooth};
            const Shape nested =
                Combination{Kind::Union, {{inner}, {parts[2]}, {parts[3]}}, smooth};
            const auto joined = [&](double a, double b) {  // of a union
                const double overlap = std::max(smooth - std::abs(a - b), 0.0);
                return std::min(a, b) - (smooth > 0 ? overlap * overlap / (4 * smooth) : 0);
            };
            for (int k = 0; k < 2000; ++k) {
                const Vec3 x = random_point(random);
                double expected = signed_distance(parts[0], x);
                for (const Shape& part : {parts[1], ring}) {
                    const double other = signed_distance(part, x);
                    expected = kind == Kind::Union        ? joined(expected, other)
                               : kind == Kind::Difference ? -joined(-expected, other)
                                                          : -joined(-expected, -other);
                }
                for (const Shape& part : {parts[2], parts[3]})
                    expected = joined(expected, signed_distance(part, x));
                REQUIRE(signed_distance(nested, x) == expected);
            }
        }
}

TEST_CASE("a distance that is less than enough is exact, one that is not lies between") {
    using Kind = Combination::Kind;
    std::mt19937 random(8);
    std::vector<Shape> of = composed();
    const Shape chain = Combination{// fillets of fillets
                                    Kind::Union,
                                    {{Sphere{{-1, 0, 0}, 0.5}},
                                     {Sphere{{-0.4, 0.3, 0}, 0.4}},
                                     {block},
                                     {Sphere{{1, 0, 0}, 0.6}}},
                                    0.6};
    of.push_back(chain);
    of.push_back(
        Combination{Kind::Union, {{chain}, {of[4]}, {moved(of[2], {1, 0, 0}, {0, 1, 0})}}, 0});
    of.push_back(Combination{Kind::Difference, {{chain}, {of[6]}}, 0.2});
    std::uniform_real_distribution<double> sizes(-0.5, 1.5);
    int n_exact = 0, n_less = 0;
    for (const Shape& shape : of)
        for (int i = 0; i < 4000; ++i) {
            const Vec3 x = random_point(random);
            const double exact = signed_distance(shape, x), enough = sizes(random),
                         found = distance_up_to(shape, x, enough);
            if (exact < enough) {
                REQUIRE(found == exact);
                ++n_exact;
            } else {
                REQUIRE(found >= enough);
                REQUIRE(found <= exact + rounding);
                n_less += found < exact;
            }
        }
    CHECK(n_exact > 1000);
    CHECK(n_less > 1000);
}
