// What bodies keep while corners are freed and slaved, held and let go.
#include "tests/support/squashed_columns.h"

#include <catch2/catch.hpp>

#include <algorithm>

namespace {

constexpr double frame_time = 1.0 / 24;

}  // namespace

TEST_CASE("corners of a held body that strain frees and slaves give it no energy") {
    const sim::Steps steps =
        GENERATE(sim::Steps::Explicit, sim::Steps::Bdf2, sim::Steps::Implicit);
    sim::Simulation simulation(tests::squashed_columns(1, steps), frame_time);
    const double start = tests::energy(simulation.stats());
    int n_changes = 0, before = tests::n_enriched(simulation);
    CHECK(before == 0);
    double highest = 0;
    for (int k = 1; k <= 200; ++k) {
        simulation.advance_to(0.005 * k);
        const int now = tests::n_enriched(simulation);
        n_changes += now != before;
        before = now;
        highest = std::max(highest, tests::energy(simulation.stats()) / start);
    }
    CAPTURE(int(steps), n_changes, highest);
    CHECK(n_changes > 3);
    CHECK(highest < 1 + 1e-3);
}

TEST_CASE("letting go of one body leaves the motion of another as it is") {
    // Explicit steps of one body depend on the other by their length alone.
    sim::Scene both = tests::squashed_columns(2, sim::Steps::Explicit);
    both.solver.method = sim::Method::Domains;
    both.solver.enrich.strain = false;  // else the grid is at rest
    both.bodies[0].velocity = {1, 0, 0};
    both.pins[0].until = 0.05;
    sim::Scene alone = both;
    alone.bodies.erase(alone.bodies.begin());
    alone.pins.erase(alone.pins.begin());
    alone.probes.erase(alone.probes.begin());
    sim::Simulation with(both, frame_time), without(alone, frame_time);
    double worst = 0, way = 0;
    for (int k = 1; k <= 30; ++k) {
        with.advance_to(0.01 * k);
        without.advance_to(0.01 * k);
        const Vec3 top = without.probes()[0].position;
        worst = std::max(worst, (with.probes()[1].position - top).norm());
        way = std::max(way, (top - Vec3(3.1, 0.1, 0.8)).norm());
    }
    CHECK((with.probes()[0].position - Vec3(0.1, 0.1, 0.8)).norm() > 0.1);
    CHECK(way > 0.1);
    CHECK(worst < 1e-9 * way);
}

TEST_CASE("mass lumped at nodes is harder to turn by h²/8 along each axis") {
    // A cube of six domains and three cells: Σ m x² is L²/12 (1 + 2/6²) by corners (the trapezoidal rule), and h²/8 more by
    // nodes, as every other corner lies on one and the others halfway between two.
    sim::Scene scene;
    scene.bodies = {tests::soft_block("cube", {0, 0, 0}, Vec3::Constant(0.6), 0.1, 1e5)};
    scene.bodies[0].spin = {0, 0, 1};
    const auto inertia = [&](sim::Method method) {
        scene.solver.method = method;
        return sim::Simulation(scene, frame_time).stats().angular_momentum.z();
    };
    const double mass = 1000 * 0.216, of_corners = 0.36 / 12 * (1 + 2.0 / 36);
    CHECK(inertia(sim::Method::Fem) == Approx(2 * mass * of_corners).epsilon(1e-9));
    CHECK(inertia(sim::Method::Domains)
          == Approx(2 * mass * (of_corners + 0.04 / 8)).epsilon(1e-9));
}

TEST_CASE(
    "a swinging column that is let go keeps its momentum from then on, and gains no energy") {
    const sim::Steps steps = GENERATE(sim::Steps::Explicit, sim::Steps::Bdf2);
    const sim::Method method = GENERATE(sim::Method::Enriched, sim::Method::Domains);
    sim::Scene scene = tests::squashed_columns(2, steps);
    scene.bodies.erase(scene.bodies.begin());
    scene.pins = {tests::foot_of("column1")};
    scene.pins[0].until = 0.1;
    scene.probes.clear();
    scene.solver.method = method;
    scene.solver.enrich.strain = false;
    sim::Simulation simulation(scene, frame_time);
    simulation.advance_to(0.1);
    const double held = tests::energy(simulation.stats());
    simulation.advance_to(0.14);  // BDF2 has forgotten the pin
    const sim::Stats start = simulation.stats();
    CHECK(start.linear_momentum.norm() > 1);
    CHECK(start.angular_momentum.norm() > 1);
    simulation.advance_to(0.5);
    const sim::Stats now = simulation.stats();
    CAPTURE(int(steps), int(method), held, tests::energy(start), tests::energy(now));
    CHECK((now.linear_momentum - start.linear_momentum).norm()
          < 1e-12 * start.linear_momentum.norm());
    CHECK((now.angular_momentum - start.angular_momentum).norm()
          < (steps == sim::Steps::Explicit ? 1e-12 : 5e-3) * start.angular_momentum.norm());
    CHECK(tests::energy(start) < held * (1 + 1e-6));
    CHECK(tests::energy(now) == Approx(tests::energy(start)).epsilon(0.01));
    CHECK(tests::energy(now) < tests::energy(start) * (1 + 1e-3));
}
