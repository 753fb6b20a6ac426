// Bodies against each other and themselves, by their surfaces.
#include "sim/simulation.h"

#include <catch2/catch.hpp>

#include <cmath>

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
    const double speed = GENERATE(2.0, 10.0);
    const double shift = GENERATE(0.0, 0.12);  // of one cube, across
    const double dt = GENERATE(1e-3, 4e-3);
    const sim::Steps steps =
        GENERATE(sim::Steps::Implicit, sim::Steps::Bdf2, sim::Steps::Explicit);
    CAPTURE(speed, shift, dt, int(steps));
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    scene.solver.steps = steps;
    scene.solver.dt = dt;
    scene.bodies.push_back(block("left", {-0.31, 0, 0}, {0.3, 0.3, 0.3}, 0.05, 1e5));
    scene.bodies.push_back(block("right", {0.01, shift, shift}, {0.3, 0.3, 0.3}, 0.05, 1e5));
    scene.bodies[0].velocity = {speed / 2, 0.1, 0};
    scene.bodies[1].velocity = {-speed / 2, 0.1, 0};
    sim::Simulation simulation(scene, frame_time);
    const sim::Stats start = simulation.stats();
    double deepest = 0, highest = energy(start);
    for (int k = 1; k <= 25; ++k) {
        simulation.advance_to(4e-3 * k);
        const sim::Stats now = simulation.stats();
        CHECK((now.linear_momentum - start.linear_momentum).norm() < 1e-9 * 13.5 * speed);
        CHECK((now.angular_momentum - start.angular_momentum).norm()
              < 0.02 * start.angular_momentum.norm() + 1e-9);
        CHECK(energy(now) < highest * (1 + 1e-3));
        highest = std::min(highest, energy(now));
        deepest = std::max(deepest, now.penetration);
    }
    WARN("deepest penetration " << deepest << " domain edges; energy kept "
                                << highest / energy(start));
    CHECK(deepest < 0.02);
    CHECK(highest < 0.9999 * energy(start));  // they have met
}
