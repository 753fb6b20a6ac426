#include "tests/support/soft_block.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace {

constexpr double frame_time = 1.0 / 24;

}  // namespace

TEST_CASE("a block on a slope of 30 degrees slides (g sin - mu g cos) t²/2, or stays") {
    // The slope is a level plane under tilted gravity. tan 30° = 0.577. The block is stiff: a soft one sticks at first,
    // while it shears, and runs ahead of the formula by that.
    const double g = 9.81, angle = 3.14159265358979323846 / 6;
    const sim::Friction friction = GENERATE(sim::Friction{false, 0.0},
                                            sim::Friction{false, 0.2},
                                            sim::Friction{false, 0.4},
                                            sim::Friction{false, 0.7},
                                            sim::Friction{true, 0});
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    // Friction follows the normal force of the step before: first order in dt.
    scene.solver.dt = 0.5e-3;
    scene.bodies.push_back(tests::soft_cube("block", {0, 0, 0}, 0.2, 2, 1e7));
    scene.forces.push_back(sim::Gravity{{g * std::sin(angle), 0, -g * std::cos(angle)}});
    scene.colliders.push_back({sim::PlaneShape{{0, 0, 0}, {0, 0, 1}}, friction});
    scene.probes.push_back({"centre", "block", Vec3(0.1, 0.1, 0.1)});
    sim::Simulation simulation(scene, frame_time);
    simulation.advance_to(1);
    const double slid = simulation.probes()[0].position.x() - 0.1;
    const double mu = friction.stick ? 1 : friction.coefficient;
    const double expected = std::max(0.0, g * std::sin(angle) - mu * g * std::cos(angle)) / 2;
    CHECK(slid == Approx(expected).epsilon(0.01).margin(2e-3));  // sticking creeps below 1 mm/s
}

TEST_CASE(
    "a dropped cube comes to rest on a plane, a sphere and a box, without gaining energy") {
    const int which = GENERATE(0, 1, 2);
    sim::Scene scene;
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    scene.solver.dt = 2e-3;
    scene.solver.damping = 2;
    scene.bodies.push_back(tests::soft_cube("cube", {-0.1, -0.1, 0.05}, 0.2, 4, 1e5));
    scene.forces.push_back(sim::Gravity{{0, 0, -10}});
    const sim::Friction rough = GENERATE(sim::Friction{false, 0.3}, sim::Friction{true, 0});
    if (which == 0)
        scene.colliders.push_back({sim::PlaneShape{{0, 0, 0}, {0, 0, 1}}, rough});
    else if (which == 1)
        scene.colliders.push_back({assets::Sphere{{0, 0, -1}, 1}, rough});
    else
        scene.colliders.push_back({assets::Box{{-1, -1, -1}, {1, 1, 0}}, rough});
    scene.probes.push_back({"foot", "cube", Vec3(0, 0, 0.05)});
    sim::Simulation simulation(scene, frame_time);
    double highest = tests::energy(simulation.stats());
    const double fall = 8 * 10 * 0.05;  // m g h [J]
    for (int k = 1; k <= 60; ++k) {
        simulation.advance_to(0.05 * k);
        CHECK(tests::energy(simulation.stats()) < highest + 1e-3 * fall);
        highest = std::max(highest, tests::energy(simulation.stats()));
    }
    CHECK(simulation.probes()[0].position.z() == Approx(0).margin(0.02 * 0.05));  // of a domain
    CHECK(simulation.stats().kinetic_energy < 1e-3 * fall);
}

TEST_CASE("two cubes meeting at 2 m/s keep their momentum, lose energy, and do not pass") {
    sim::Scene scene;
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    scene.solver.dt = 1e-3;
    sim::Body left = tests::soft_cube("left", {-0.31, 0, 0}, 0.3, 6, 1e5),
              right = tests::soft_cube("right", {0.01, 0, 0}, 0.3, 6, 1e5);
    left.velocity = {1.5, 0.2, 0};
    right.velocity = {-0.5, 0.2, 0};
    scene.bodies = {left, right};
    scene.probes.push_back({"left", "left", Vec3(-0.16, 0.15, 0.15)});
    scene.probes.push_back({"right", "right", Vec3(0.16, 0.15, 0.15)});
    sim::Simulation simulation(scene, frame_time);
    const sim::Stats start = simulation.stats();
    for (int k = 1; k <= 20; ++k) {
        simulation.advance_to(0.01 * k);
        const sim::Stats now = simulation.stats();
        CHECK((now.linear_momentum - start.linear_momentum).norm()
              < 1e-11 * start.linear_momentum.norm());
        CHECK(tests::energy(now) <= tests::energy(start) * (1 + 1e-6));
        const auto probes = simulation.probes();
        CHECK(probes[1].position.x() - probes[0].position.x() > 0.8 * 0.3);
    }
    // They met, and part again.
    CHECK(tests::energy(simulation.stats()) < 0.99 * tests::energy(start));
    CHECK(simulation.probes()[0].position.x() < -0.16 + 1.5 * 0.2 - 0.05);
}

TEST_CASE("single linearised solves make no energy where a cube hits what stands still") {
    // A solve that does not see the contact ends deep in it: what that step would store, and give back, is refused.
    const double speed = GENERATE(2.0, 5.0, 20.0);
    const bool on_sphere = GENERATE(false, true);
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    scene.solver.steps = sim::Steps::SemiImplicit;
    scene.solver.dt = 4e-3;
    scene.bodies.push_back(tests::soft_cube("cube", {-0.15, -0.15, 0.02}, 0.3, 6, 1e5));
    scene.bodies[0].velocity = {0, 0, -speed};
    if (on_sphere)
        scene.colliders.push_back({assets::Sphere{{0, 0, -0.5}, 0.5}, {}});
    else
        scene.colliders.push_back({sim::PlaneShape{{0, 0, 0}, {0, 0, 1}}, {}});
    scene.probes.push_back({"cube", "cube", std::string("all")});
    sim::Simulation simulation(scene, frame_time);
    const double start = tests::energy(simulation.stats());
    CAPTURE(speed, on_sphere);
    for (int k = 1; k <= 20; ++k) {
        simulation.advance_to(4e-3 * k);
        CHECK(tests::energy(simulation.stats()) < 1.001 * start);
    }
    CHECK(tests::energy(simulation.stats()) < 0.9 * start);  // it has met
    CHECK(simulation.probes()[0].position.z() > 0.05);
}

TEST_CASE("how many equilibria lead to it changes nothing in how bodies are pressed together") {
    // Two cubes, the upper one moved down onto the lower one by a tenth of an edge, in one step or in seven.
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    scene.solver.steps = sim::Steps::Static;
    scene.bodies = {tests::soft_cube("lower", {0, 0, 0}, 0.4, 4, 1e5),
                    tests::soft_cube("upper", {0, 0, 0.41}, 0.4, 4, 1e5)};
    scene.pins = {
        {"floor", "lower", {sim::Selector::HalfSpace{{0, 0, 0.01}, {0, 0, 1}}, {}}, {}},
        {"ram",
         "upper",
         {sim::Selector::HalfSpace{{0, 0, 0.8}, {0, 0, -1}}, {}},
         sim::Pin::Velocity{{0, 0, -0.05}}}};
    double force[2], depth[2];
    for (const int n : {1, 7}) {
        sim::Simulation simulation(scene, frame_time);
        for (int k = 1; k <= n; ++k)
            simulation.advance_to(1.0 * k / n);
        force[n > 1] = simulation.pins()[0].force.z();
        depth[n > 1] = simulation.stats().penetration;
    }
    CHECK(force[0] > 100);
    CHECK(force[1] == Approx(force[0]).epsilon(1e-3));
    CHECK(depth[0] > 1e-4);
    CHECK(depth[1] == Approx(depth[0]).epsilon(0.02));
}
