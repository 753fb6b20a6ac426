#include "sim/diagnosis.h"
#include "sim/simulation.h"
#include "tests/support/soft_block.h"

#include <catch2/catch.hpp>

#include <limits>

using Catch::Matchers::Contains;

namespace {

sim::Scene two_blocks() {
    sim::Scene scene;
    scene.bodies = {tests::soft_block("left", {0, 0, 0}, {0.2, 0.1, 0.1}, 0.1, 1e5),
                    tests::soft_block("right", {1, 0, 0}, {0.2, 0.1, 0.1}, 0.1, 1e5)};
    sim::Region end = scene.bodies[1].regions[0];
    end.name = "end";
    end.select.is = assets::Box{{1.1, 0, 0}, {1.2, 0.1, 0.1}};
    scene.bodies[1].regions.push_back(end);
    return scene;
}

}  // namespace

TEST_CASE("what has flown apart is told by body, region, place, speed and time") {
    const sim::Scene scene = two_blocks();
    const sim::Assembly assembly(scene);
    sim::State state;
    state.time = 0.25;
    state.x = assembly.rest;
    state.v.assign(state.x.size(), sim::Vec3p{1, 0, 0, 0});
    const double speed = GENERATE(3e7, std::numeric_limits<double>::quiet_NaN());
    std::size_t c = assembly.bodies[1].begin;
    while (state.x[c][0] < 1.15)
        ++c;
    state.v[c] = sim::Vec3p{0, speed, 0, 0};
    const assets::Error error = sim::diagnose_flown_apart(scene, assembly, state);
    CHECK(error.kind() == assets::ErrorKind::Diverged);
    for (const char* part : {"0.25 s", "body \"right\"", "region \"end\"", "at (1.2, 0, 0)"})
        CHECK_THAT(error.what(), Contains(part));
    CHECK_THAT(error.what(), Contains(speed > 0 ? "3e+07 m/s" : "nan m/s"));
}

TEST_CASE("who asks for more steps than can be taken is told") {
    sim::Scene scene = two_blocks();
    scene.solver.steps = sim::Steps::Explicit;
    std::string asks = "body \"right\" ";
    if (GENERATE(true, false)) {
        scene.bodies[1].velocity = {1e12, 0, 0};
        asks += "moves at 1e+12 m/s";
    } else {
        scene.bodies[1].regions[1].young_modulus = 1e25;
        asks += "is so stiff and light";
    }
    sim::Simulation simulation(scene, 1.0 / 24);
    CHECK_THROWS_WITH(simulation.advance_to(1.0 / 24), Contains(asks));
}
