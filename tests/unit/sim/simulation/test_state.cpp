#include "assets/base/error.h"
#include "sim/simulation.h"
#include "tests/support/bar_scene.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

namespace {

constexpr double frame_time = 1.0 / 24;

sim::Scene bar(sim::Method method) {
    tests::BarOptions options;
    options.solver.method = method;
    options.solver.dt = 2e-3;
    return tests::bar_scene(options);
}

const sim::Method all_methods[] = {
    sim::Method::Fem, sim::Method::Enriched, sim::Method::Domains};

}  // namespace

TEST_CASE("a restored checkpoint goes on to the same bits") {
    for (const sim::Method method : all_methods) {
        sim::Simulation whole(bar(method), frame_time), first(bar(method), frame_time),
            second(bar(method), frame_time);
        whole.advance_to(0.05);
        first.advance_to(0.05);
        second.restore(first.checkpoint());
        CHECK(second.time() == first.time());
        whole.advance_to(0.1);
        second.advance_to(0.1);
        CHECK(whole.checkpoint() == second.checkpoint());
        CHECK_FALSE(whole.checkpoint() == first.checkpoint());
    }
}

TEST_CASE("one thread and two give the same bits") {
    tests::BarOptions options;
    options.n_domains = {60, 12, 12};  // several bricks, cells and chunks
    options.segment_ends = {20, 40};
    options.domain_size = 0.0125;
    options.solver.dt = 2e-3;
    std::vector<std::byte> states[2];
    for (const int n_threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        n_threads);
        sim::Simulation simulation(tests::bar_scene(options), frame_time);
        simulation.advance_to(0.02);
        states[n_threads - 1] = simulation.checkpoint();
    }
    CHECK(states[0] == states[1]);
}

TEST_CASE("an equilibrium of a body that nothing holds is refused with its cause") {
    tests::BarOptions options;
    options.solver.steps = sim::Steps::Static;
    sim::Scene scene = tests::bar_scene(options);
    scene.pins.clear();
    try {
        sim::Simulation simulation(scene, frame_time);
        FAIL("found an equilibrium");
    } catch (const assets::Error& error) {
        CHECK(error.kind() == assets::ErrorKind::Diverged);
        CHECK_THAT(error.what(), Catch::Contains("nothing holds the body"));
    }
}

TEST_CASE("pins move as told and let go") {
    sim::Scene scene = bar(sim::Method::Enriched);
    scene.forces.clear();
    const double rate = 3.0;
    scene.pins[0].moves = sim::Pin::Spin{{1, 0, 0}, {0, 0, 0}, rate};
    scene.pins[0].until = 0.06;
    scene.probes = {{"edge", "bar", Vec3(0, 0.0875, 0)}};
    sim::Simulation simulation(scene, frame_time);
    simulation.advance_to(0.05);
    const Vec3 turned(0, 0.0875 * std::cos(0.05 * rate), 0.0875 * std::sin(0.05 * rate));
    CHECK((simulation.probes()[0].position - turned).norm() < 1e-12);
    simulation.advance_to(0.2);
    CHECK(simulation.pins()[0].force.norm() == 0);
    CHECK(std::abs(simulation.probes()[0].position.x()) > 1e-6);
}
