#include "tests/support/soft_block.h"

#include <catch2/catch.hpp>

TEST_CASE("steps that fail are halved and told, and grow back once the motion is calm") {
    // The top of a bar is torn aside at 40 m/s for 20 ms, faster than its waves run, and let go.
    constexpr double dt = 0.02, until = dt;
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    scene.solver.steps = GENERATE(sim::Steps::Implicit, sim::Steps::Bdf2);
    scene.solver.dt = dt;
    scene.solver.damping = 5;
    scene.bodies = {tests::soft_block("bar", {0, 0, 0}, {0.3, 0.1, 0.1}, 0.05, 1e5)};
    scene.pins = {tests::foot_of("bar"), tests::foot_of("bar")};
    scene.pins[1].name = "hand";
    scene.pins[1].select.is = sim::Selector::HalfSpace{{0, 0, 0.099}, {0, 0, -1}};
    scene.pins[1].moves = sim::Pin::Velocity{{40, 0, -10}};
    scene.pins[1].until = until;
    CAPTURE(int(scene.solver.steps));
    sim::Simulation simulation(scene, 1.0 / 24);
    simulation.advance_to(until);
    CHECK(simulation.stats().steps > 2);
    REQUIRE(!simulation.failures().empty());
    CHECK_THAT(simulation.failures()[0], Catch::Matchers::Contains("bar"));
    simulation.advance_to(1.6);
    simulation.advance_to(1.6 + 10 * dt);
    CHECK(simulation.failures().empty());
    CHECK(simulation.stats().steps == 10);
    CHECK(simulation.stats().kinetic_energy < 1);
}
