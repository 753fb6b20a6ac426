// Bodies that come to rest on each other, on themselves, and on slopes of each other, by their surfaces.
#include "tests/support/soft_block.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <string>

namespace {

constexpr double frame_time = 1.0 / 24;

}  // namespace

TEST_CASE("a strip that folds comes to lie on itself") {
    // Its one end is carried over the other, and let go.
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    scene.solver.dt = 2e-3;
    scene.solver.damping = 2;
    scene.bodies.push_back(tests::soft_block("strip", {0, 0, 0}, {1.2, 0.1, 0.05}, 0.05, 2e4));
    scene.forces.push_back(sim::Gravity{{0, 0, -10}});
    scene.colliders.push_back({sim::PlaneShape{{0, 0, 0}, {0, 0, 1}}, {true, 0}});
    sim::Pin end;
    end.name = "end";
    end.body = "strip";
    end.select.is = sim::Selector::HalfSpace{{1.15, 0, 0}, {-1, 0, 0}};
    end.moves = sim::Pin::Spin{{0, -1, 0}, {0.8, 0.05, 0.1}, 3.0};
    end.until = 1.0;
    scene.pins.push_back(end);
    scene.probes = {{"end", "strip", Vec3(1.2, 0.05, 0.025)}};
    sim::Simulation simulation(scene, frame_time);
    double deepest = 0;
    for (int k = 1; k <= 50; ++k) {
        simulation.advance_to(0.04 * k);
        deepest = std::max(deepest, simulation.stats().penetration);
    }
    WARN("deepest penetration " << deepest << " domain edges");
    CHECK(deepest < 0.02);
    CHECK(simulation.probes()[0].position.x() < 0.6);   // folded over
    CHECK(simulation.probes()[0].position.z() > 0.06);  // on top of itself
}

TEST_CASE("a stack rests with less than 1% of a domain inside each other") {
    // At 1e5 Pa it would fall over: a column so soft buckles under its own weight from 0.64 m.
    sim::Scene scene;
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    scene.solver.dt = 2e-3;
    scene.solver.damping = 6;
    scene.forces.push_back(sim::Gravity{{0, 0, -10}});
    scene.colliders.push_back({sim::PlaneShape{{0, 0, 0}, {0, 0, 1}}, {false, 0.5}});
    scene.contact.friction = {false, 0.5};
    for (int k = 0; k < 3; ++k) {
        const std::string name = "cube" + std::to_string(k);
        scene.bodies.push_back(tests::soft_block(
            name.c_str(), {0.03 * k, 0, 0.002 + 0.202 * k}, {0.2, 0.2, 0.2}, 0.05, 1e6));
        scene.probes.push_back({name, name, std::string("all")});
    }
    sim::Simulation simulation(scene, frame_time);
    simulation.advance_to(1.2);
    const sim::Stats stats = simulation.stats();
    CHECK(stats.penetration < 0.01);
    CHECK(stats.collider_penetration < 0.01);
    CHECK(stats.kinetic_energy < 1e-3);
    // It leans: the weight that hangs over bends it by M L / (E I) a cube, some 6 mm at the top.
    for (int k = 0; k < 3; ++k)
        CHECK(simulation.probes()[k].position.x() == Approx(0.1 + 0.03 * k).margin(0.01));
}

TEST_CASE(
    "a block on another slides down by (g sin - mu g cos) t²/2, or stays, as their pair's "
    "friction says") {
    // Gravity leans by 20 degrees. Both are stiff, so that they tip and bend little.
    const double mu = GENERATE(0.1, 0.6);
    CAPTURE(mu);
    const double angle = 20 * std::numbers::pi / 180, g = 10, duration = 0.4;
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    scene.solver.dt = 1e-3;
    scene.forces.push_back(sim::Gravity{{g * std::sin(angle), 0, -g * std::cos(angle)}});
    scene.contact.friction = {false, 0.3};
    scene.contact.pairs = {{{"top", "slab"}, {false, mu}}};
    scene.bodies = {tests::soft_block("slab", {0, 0, 0}, {1.2, 0.2, 0.1}, 0.05, 1e7),
                    tests::soft_block("top", {0.1, 0, 0.1001}, {0.2, 0.2, 0.1}, 0.05, 1e7)};
    scene.pins = {tests::foot_of("slab")};
    scene.probes = {{"top", "top", std::string("all")}};
    sim::Simulation simulation(scene, frame_time);
    const double start = simulation.probes()[0].position.x();
    simulation.advance_to(duration);
    const double way =
        std::max(0.0, g * (std::sin(angle) - mu * std::cos(angle))) * duration * duration / 2;
    // It is in the air for a moment at first, and each time it hops.
    CHECK(simulation.probes()[0].position.x() - start == Approx(way).margin(0.02));
}
