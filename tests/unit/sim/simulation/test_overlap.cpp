// Bodies that touch colliders, or lie in them, when a shot starts.
#include "assets/base/error.h"
#include "sim/simulation.h"
#include "tests/support/soft_block.h"

#include <catch2/catch.hpp>

namespace {

constexpr double frame_time = 1.0 / 24, edge = 0.1, young_modulus = 1e5;

/// A block on, or `depth` into, the ground, 4 x 4 domains wide and `height` high.
sim::Scene block_on_ground(double height, double depth) {
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    scene.solver.dt = 1e-3;
    scene.bodies = {tests::soft_block(
        "block", {-0.2, -0.2, -depth}, {0.4, 0.4, height}, edge, young_modulus)};
    scene.colliders.push_back({sim::PlaneShape{{0, 0, -1}, {0, 0, 1}}, {}});  // far below
    scene.colliders.push_back({sim::PlaneShape{{0, 0, 0}, {0, 0, 1}}, {}});
    return scene;
}

std::string refusal(const sim::Scene& scene) {
    try {
        const sim::Simulation simulation(scene, frame_time);
    } catch (const assets::Error& error) {
        CHECK(error.kind() == assets::ErrorKind::Input);
        CHECK(error.key() == "body.block");
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("a body that starts inside a collider is refused with body, collider and depth") {
    const std::string message = refusal(block_on_ground(0.4, 0.3 * edge));
    CHECK_THAT(message, Catch::Contains("body \"block\""));
    CHECK_THAT(message, Catch::Contains("collider 2"));
    CHECK_THAT(message, Catch::Contains("0.03 m"));
    CHECK(refusal(block_on_ground(0.4, 0.04 * edge)).empty());
    CHECK(refusal(block_on_ground(0.4, 0)).empty());
}

TEST_CASE("what pins hold may lie inside a collider") {
    sim::Scene scene = block_on_ground(0.4, 0.3 * edge);
    scene.pins = {tests::foot_of("block")};
    CHECK(refusal(scene).empty());
}

TEST_CASE("points that just touch the ground make no energy, however their cubes are cut") {
    const double height = GENERATE(0.31, 0.32, 0.33, 0.345, 0.36, 0.377, 0.39, 0.4);
    sim::Scene scene = block_on_ground(height, 0);
    scene.solver.method = sim::Method::Mpm;
    scene.solver.steps = GENERATE(sim::Steps::Explicit, sim::Steps::Implicit);
    sim::Simulation simulation(scene, frame_time);
    simulation.advance_to(frame_time);
    const sim::Stats stats = simulation.stats();
    CAPTURE(height);
    // Against what the contact of a whole cube's depth of 1e-6 would hold: k d²/2, k = 100 E s.
    CHECK(stats.kinetic_energy + stats.elastic_energy
          < 0.5 * 100 * young_modulus * edge * 1e-14);
}
