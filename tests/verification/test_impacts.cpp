// Bodies against each other and themselves, by their surfaces.
#include "sim/simulation.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>

namespace {

constexpr double frame_time = 1.0 / 24;

sim::Body block(const char* name, const Vec3& low, const Vec3& size, double edge, double E) {
    sim::Body body;
    body.name = name;
    body.domain_size = edge;
    body.source.geometry = assets::Shape{assets::Box{low, low + size}};
    body.skins.push_back({"outside", {}});
    sim::Region region;
    region.name = "all";
    region.select.is = sim::Selector::All{};
    region.model = sim::Model::StableNeoHookean;
    region.young_modulus = E;
    region.poisson_ratio = 0.3;
    region.density = 1000;
    body.regions.push_back(region);
    return body;
}

double energy(const sim::Stats& stats) {
    return stats.kinetic_energy + stats.elastic_energy + stats.gravitational_energy;
}

}  // namespace

TEST_CASE(
    "two cubes meet: they keep their momentum, gain no energy, and stay out of each other") {
    using sim::Steps;
    // Shift of one cube across [m], step [s].
    const double speed = 2;
    const auto [shift, dt, steps] =
        GENERATE(table<double, double, Steps>({{0, 4e-3, Steps::Implicit},
                                               {0.12, 1e-3, Steps::Implicit},
                                               {0, 4e-3, Steps::Bdf2},
                                               {0.12, 1e-3, Steps::Bdf2},
                                               {0, 4e-3, Steps::Explicit},
                                               {0.12, 1e-3, Steps::Explicit}}));
    CAPTURE(shift, dt, int(steps));
    sim::Scene scene;
    scene.contact.mode = sim::Contact::Mode::Surface;
    scene.solver.method = sim::Method::Fem;
    scene.solver.steps = steps;
    scene.solver.dt = dt;
    scene.bodies.push_back(block("left", {-0.31, 0, 0}, {0.3, 0.3, 0.3}, 0.05, 1e5));
    scene.bodies.push_back(block("right", {0.01, shift, shift}, {0.3, 0.3, 0.3}, 0.05, 1e5));
    scene.bodies[0].velocity = {speed / 2, 0.1, 0};
    scene.bodies[1].velocity = {-speed / 2, 0.1, 0};
    sim::Simulation simulation(scene, frame_time);
    const sim::Stats start = simulation.stats();
    const double momentum = 0.5 * speed * start.total_mass;
    double deepest = 0, highest = energy(start), lowest = highest;
    for (int k = 1; k <= 25; ++k) {
        simulation.advance_to(4e-3 * k);
        const sim::Stats now = simulation.stats();
        CHECK((now.linear_momentum - start.linear_momentum).norm() < 1e-9 * momentum);
        CHECK((now.angular_momentum - start.angular_momentum).norm() < 0.01 * momentum * 0.3);
        CHECK(energy(now) < highest * (1 + 1e-3));
        // What velocity Verlet keeps is not the energy itself, but one that differs where modes swing fast.
        if (steps != Steps::Explicit)
            highest = std::min(highest, energy(now));
        lowest = std::min(lowest, energy(now));
        deepest = std::max(deepest, now.penetration);
    }
    WARN("deepest penetration " << deepest << " domain edges; energy kept "
                                << lowest / energy(start));
    CHECK(deepest < 0.02);
    CHECK(lowest < 0.99 * energy(start));  // they have met
}

TEST_CASE("a ball of 20 m/s does not pass through a plate thinner than a domain") {
    sim::Scene scene;
    scene.contact.mode = sim::Contact::Mode::Surface;
    scene.solver.method = sim::Method::Fem;
    scene.solver.dt = 1e-3;
    scene.bodies.push_back(block("plate", {-0.3, -0.3, 0}, {0.6, 0.6, 0.03}, 0.05, 1e6));
    sim::Body ball = block("ball", {0, 0, 0}, {1, 1, 1}, 0.05, 1e6);
    ball.source.geometry = assets::Shape{assets::Sphere{{0, 0, 0.2}, 0.1}};
    ball.velocity = {0, 0, -20};
    scene.bodies.push_back(ball);
    sim::Pin rim;
    rim.name = "rim";
    rim.body = "plate";
    rim.select.is = sim::Selector::HalfSpace{{-0.29, 0, 0}, {1, 0, 0}};
    scene.pins.push_back(rim);
    scene.probes = {{"ball", "ball", std::string("all")}, {"plate", "plate", Vec3(0, 0, 0.03)}};
    sim::Simulation simulation(scene, frame_time);
    for (int k = 1; k <= 40; ++k) {
        simulation.advance_to(1e-3 * k);
        const auto probes = simulation.probes();
        REQUIRE(probes[0].position.z() > probes[1].position.z());
        CHECK(simulation.stats().penetration < 0.05);
    }
}

TEST_CASE("a strip that folds comes to lie on itself") {
    // Its one end is carried over the other, and let go.
    sim::Scene scene;
    scene.contact.mode = sim::Contact::Mode::Surface;
    scene.solver.method = sim::Method::Fem;
    scene.solver.dt = 2e-3;
    scene.solver.damping = 2;
    scene.bodies.push_back(block("strip", {0, 0, 0}, {1.2, 0.1, 0.05}, 0.05, 2e4));
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
    scene.contact.mode = sim::Contact::Mode::Surface;
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    scene.solver.dt = 2e-3;
    scene.solver.damping = 6;
    scene.forces.push_back(sim::Gravity{{0, 0, -10}});
    scene.colliders.push_back({sim::PlaneShape{{0, 0, 0}, {0, 0, 1}}, {false, 0.5}});
    scene.contact.friction = {false, 0.5};
    for (int k = 0; k < 3; ++k) {
        const std::string name = "cube" + std::to_string(k);
        scene.bodies.push_back(
            block(name.c_str(), {0.03 * k, 0, 0.002 + 0.202 * k}, {0.2, 0.2, 0.2}, 0.05, 1e6));
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
