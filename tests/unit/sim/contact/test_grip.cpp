#include "sim/contact/grip.h"
#include "sim/contact/pair_friction.h"
#include "tests/support/derivative_order.h"
#include "tests/support/random_fields.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include <cmath>

using sim::Friction;
using sim::Grip;

namespace {

constexpr double stiffness = 1e4, depth = 1e-3, dt = 1e-2, mu = 0.4;
constexpr double slip_length = 1e-5;  // of 1 mm/s in dt

const Vec3 normal = Vec3(1, -2, 3).normalized(), origin(0.3, 0.1, -0.2);

Grip grip(const Friction& friction) {
    return Grip::of(friction, stiffness, depth, dt, normal, origin);
}

Vec3 gradient(const Grip& grip, const Vec3& u) {
    Vec3 g = Vec3::Zero();
    grip.add_gradient(u, g);
    return g;
}

double energy(const Grip& grip, const Vec3& u) {
    Vec3 g = Vec3::Zero();
    return grip.add_gradient(u, g);
}

}  // namespace

TEST_CASE("a grip's gradient and Hessian are those of its energy, sticking and sliding") {
    tests::Random random(3);
    for (const double slip : {0.3 * slip_length, 4 * slip_length}) {
        Vec3 along = tests::random_vector(random);
        along = (along - normal * normal.dot(along)).normalized();
        const Vec3 u = origin + slip * along + 0.7 * slip * normal,
                   way = tests::random_vector(random).normalized();
        Grip of_pair = grip({false, mu});
        of_pair.linearize(u);
        const Vec3 other = tests::random_vector(random);
        CHECK(other.dot(of_pair.hessian() * other) >= 0);
        of_pair.linearize(u);  // as its direction is known now
        const auto slope_error = [&](double h) {
            return (energy(of_pair, u + h * way) - energy(of_pair, u - h * way)) / (2 * h)
                   - gradient(of_pair, u).dot(way);
        };
        const auto curvature_error = [&](double h) {
            return ((gradient(of_pair, u + h * way) - gradient(of_pair, u - h * way)) / (2 * h)
                    - of_pair.hessian() * way)
                .norm();
        };
        CAPTURE(slip);
        if (slip > slip_length) {
            CHECK(tests::observed_order(slope_error, 0.1 * slip_length) > 1.8);
            CHECK(tests::observed_order(curvature_error, 0.1 * slip_length) > 1.8);
        } else {
            // Quadratic: differences are exact but for rounding.
            CHECK(std::abs(slope_error(0.1 * slip_length)) < 1e-9 * mu * stiffness * depth);
            CHECK(curvature_error(0.1 * slip_length) < 1e-9 * of_pair.stiffness);
        }
        CHECK(other.dot(of_pair.hessian() * other) >= 0);
    }
}

TEST_CASE("Newton's method finds where friction lets a mass come to, by whole steps") {
    // Of m/2 |u - a|² + mu N D(|u_t|): in the plane a, shortened by mu N / m, or to a / (1 + mu N / (m e)) where it holds.
    tests::Random random(9);
    const double force = mu * stiffness * depth;
    for (int k = 0; k < 200; ++k) {
        const double m = std::pow(10.0, tests::between(random, 1, 5)),  // of dt² [kg/s²]
            pull = std::pow(10.0, tests::between(random, -1, 1));       // of mu N
        Vec3 along = tests::random_vector(random);
        along = (along - normal * normal.dot(along)).normalized();
        const Vec3 a = origin + pull * force / m * along;
        const double holding = 1 + force / (m * slip_length),
                     slides = pull * force / m - force / m;
        const Vec3 expected =
            origin + along * (slides > slip_length ? slides : pull * force / m / holding);
        Grip of_pair = grip({false, mu});
        const Vec3 side = normal.cross(along);
        Vec3 u = a + 0.5 * (a - origin).norm() * side;  // a guess from aside
        int iterations = 0;
        const auto residual = [&] { return Vec3(m * (u - a) + gradient(of_pair, u)); };
        for (; iterations < 50 && residual().norm() > 1e-6 * force; ++iterations) {
            of_pair.linearize(u);
            const Mat3 H = m * Mat3::Identity() + of_pair.hessian();
            u -= H.inverse() * residual();
        }
        CAPTURE(m, pull, iterations);
        CHECK((u - expected).norm() < 2e-6 * force / m);
        CHECK(iterations <= 12);
    }
}

TEST_CASE("friction stays in Coulomb's cone, against the slip and in the plane") {
    tests::Random random(5);
    const Grip of_pair = grip({false, mu}), sticking = grip({true, 0});
    const double most = mu * stiffness * depth;
    for (int k = 0; k < 50; ++k) {
        const double scale = std::pow(10.0, tests::between(random, -7, 0));
        const Vec3 u = origin + scale * tests::random_vector(random);
        const Vec3 moved = u - origin, slip = moved - normal * normal.dot(moved);
        const Vec3 g = gradient(of_pair, u);
        CHECK(std::abs(g.dot(normal)) <= 1e-12 * g.norm());
        CHECK(g.dot(slip) == Approx(g.norm() * slip.norm()));
        CHECK(g.norm() == Approx(most * std::min(1.0, slip.norm() / slip_length)));
        // One that sticks is a spring however far.
        CHECK((gradient(sticking, u) - stiffness * slip).norm()
              <= 1e-12 * stiffness * moved.norm());
    }
}

TEST_CASE(
    "a grip's energy is that of a spring, and on from there grows by the force along the way") {
    const Grip of_pair = grip({false, mu});
    const double force = mu * stiffness * depth;
    const Vec3 along = normal.cross(Vec3::UnitX()).normalized();
    for (const double slips : {0.5, 1.0, 3.0})
        CHECK(energy(of_pair, origin + slips * slip_length * along)
              == Approx(force * slip_length * (slips < 1 ? slips * slips / 2 : slips - 0.5)));
}

TEST_CASE("nothing is gripped that does not touch, has no friction, or no time to slip") {
    CHECK_FALSE(Grip::of({false, mu}, stiffness, 0, dt, normal, origin).holds());
    CHECK_FALSE(Grip::of({false, 0}, stiffness, depth, dt, normal, origin).holds());
    CHECK_FALSE(Grip::of({true, 0}, stiffness, depth, 0, normal, origin).holds());
    CHECK(grip({true, 0}).holds());
}

TEST_CASE("the last pair that names both bodies in any order has its friction") {
    sim::Scene scene;
    for (const char* name : {"a", "b", "c"}) {
        scene.bodies.emplace_back();
        scene.bodies.back().name = name;
    }
    scene.contact.friction = {false, 0.3};
    scene.contact.pairs = {
        {{"a", "b"}, {false, 0.1}}, {{"b", "a"}, {false, 0.2}}, {{"c", "c"}, {true, 0}}};
    const sim::PairFriction friction(scene);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const bool is_named = i != j && i < 2 && j < 2;
            CHECK(friction.between(i, j).coefficient
                  == (i == 2 && j == 2 ? 0
                      : is_named       ? 0.2
                                       : 0.3));
            CHECK(friction.between(i, j).stick == (i == 2 && j == 2));
        }
}
