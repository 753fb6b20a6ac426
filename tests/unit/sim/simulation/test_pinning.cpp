#include "sim/pinning.h"
#include "sim/simulation.h"
#include "tests/support/bar_scene.h"
#include "tests/support/soft_block.h"

#include <catch2/catch.hpp>

#include <string>

namespace {

constexpr double quarter_turn = 3.14159265358979323846 / 2;

sim::Pin end_pin(double x_max, std::array<bool, 3> only) {
    sim::Pin pin;
    pin.name = "end";
    pin.body = "bar";
    pin.select.is = sim::Selector::HalfSpace{{x_max, 0, 0}, {1, 0, 0}};
    pin.only = only;
    return pin;
}

/// A bar of 4 x 1 x 1 domains of 0.1 m: planes of four corners at x = 0, 0.1 ... 0.4.
sim::Scene short_bar(std::vector<sim::Pin> pins) {
    tests::BarOptions options;
    options.n_domains = {4, 1, 1};
    options.segment_ends = {1, 3};
    options.domain_size = 0.1;
    sim::Scene scene = tests::bar_scene(options);
    scene.pins = std::move(pins);
    return scene;
}

sim::Prescribed prescribe(const sim::Scene& scene,
                          const sim::Assembly& assembly,
                          double time_begin,
                          double time_end) {
    sim::Prescribed prescribed;
    sim::prescribe(scene, assembly, time_begin, time_end, prescribed);
    return prescribed;
}

int count_held(const sim::Prescribed& prescribed, int axis) {
    int n = 0;
    for (const sim::Vec3p& is_free : prescribed.is_free)
        n += is_free[axis] == 0;
    return n;
}

}  // namespace

TEST_CASE("a pin stands still, moves evenly, or turns about its axis") {
    sim::Pin pin;
    const Vec3 X(1, 2, 3);
    CHECK(sim::pinned_position(pin, X, 5) == X);
    pin.moves = sim::Pin::Velocity{{1, 0, -2}};
    CHECK(sim::pinned_position(pin, X, 0.5) == Vec3(1.5, 2, 2));
    // A right-handed quarter turn about z through (1, 0, 0) takes y to -x; the axis need not be a unit vector.
    pin.moves = sim::Pin::Spin{{0, 0, 4}, {1, 0, 0}, quarter_turn};
    CHECK((sim::pinned_position(pin, X, 1) - Vec3(-1, 0, 3)).norm() < 1e-15);
}

TEST_CASE("later pins win, axis by axis") {
    sim::Pin wall = end_pin(0.15, {true, true, true}),
             slide = end_pin(0.05, {false, false, true});
    slide.moves = sim::Pin::Velocity{{7, 7, 1}};
    const sim::Scene scene = short_bar({wall, slide});
    const sim::Assembly assembly(scene);
    const sim::Prescribed prescribed = prescribe(scene, assembly, 0, 0.25);
    CHECK(prescribed.corners.size() == 8);  // the planes x = 0 and 0.1
    CHECK(std::is_sorted(prescribed.corners.begin(), prescribed.corners.end()));
    for (int axis = 0; axis < 3; ++axis)
        CHECK(count_held(prescribed, axis) == 8);
    for (int c = 0; c < assembly.n_corners(); ++c) {
        const Vec3 rest = sim::unpadded(assembly.rest[c]);
        const bool at_end = rest.x() < 0.05, is_held = rest.x() < 0.15;
        const sim::HeldBy expected = at_end    ? sim::HeldBy{0, 0, 1}
                                     : is_held ? sim::HeldBy{0, 0, 0}
                                               : sim::held_by_none;
        CHECK(prescribed.holder[c] == expected);
        const Vec3 target = rest + Vec3(0, 0, at_end ? 0.25 : 0);
        if (is_held)
            CHECK((sim::unpadded(prescribed.target[c]) - target).norm() == 0);
    }
}

TEST_CASE("a pin holds the chosen axes, to the moment of its release") {
    sim::Pin pin = end_pin(0.05, {false, true, false});
    pin.moves = sim::Pin::Velocity{{0, 2, 0}};
    pin.until = 1;
    const sim::Scene scene = short_bar({pin});
    const sim::Assembly assembly(scene);
    const sim::Prescribed during = prescribe(scene, assembly, 0, 0.5);
    CHECK(count_held(during, 0) == 0);
    CHECK(count_held(during, 1) == 4);
    // A step across the release ends where the pin let go; the next one is free.
    const sim::Prescribed across = prescribe(scene, assembly, 0.9, 1.1);
    REQUIRE(across.corners.size() == 4);
    const int c = across.corners[0];
    CHECK(across.target[c][1] == Approx(assembly.rest[c][1] + 2));

    sim::Prescribed reused = across;
    sim::prescribe(scene, assembly, 1, 1.1, reused);
    CHECK(reused.corners.empty());
    for (int k = 0; k < assembly.n_corners(); ++k) {
        CHECK(reused.holder[k] == sim::held_by_none);
        CHECK(reused.is_free[k][1] == 1);
    }
}

TEST_CASE(
    "a pin pulls at the start by what it does in steps, where it holds a body in a collider") {
    // A penalty in implicit steps, none in explicit ones, which meet colliders by impulses that a pin takes no notice of.
    const sim::Steps steps = GENERATE(sim::Steps::Implicit, sim::Steps::Explicit);
    CAPTURE(int(steps));
    sim::Scene scene = short_bar({end_pin(0, {true, true, true})});
    scene.solver.method = sim::Method::Fem;
    scene.solver.steps = steps;
    scene.solver.dt = 1e-4;
    scene.forces.clear();
    scene.colliders.push_back({sim::PlaneShape{{0.01, 0, 0}, {1, 0, 0}}, {}});
    sim::Simulation simulation(scene, 1.0 / 24);
    const Vec3 start = simulation.pins()[0].force;
    simulation.advance_to(1e-4);
    const Vec3 later = simulation.pins()[0].force;
    CAPTURE(start.transpose(), later.transpose());
    CHECK((start.norm() > 1) == (steps == sim::Steps::Implicit));
    CHECK((later - start).norm() <= 1e-3 * start.norm());
}

TEST_CASE("where several pins hold a body each tells what it does along its own axes") {
    // A block in a corner of three faces that may slide on each, pulled away from one of them.
    sim::Scene scene;
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Mpm);
    scene.solver.dt = 5e-3;
    scene.solver.damping = 50;
    scene.bodies = {tests::soft_block("block", {0, 0, 0}, {0.3, 0.3, 0.3}, 0.1, 1e6)};
    for (int axis = 0; axis < 3; ++axis) {
        sim::Pin face;
        face.name = std::string(1, "xyz"[axis]);
        face.body = "block";
        face.select.is = sim::Selector::HalfSpace{Vec3::Constant(0.01), Vec3::Unit(axis)};
        face.only = {axis == 0, axis == 1, axis == 2};
        scene.pins.push_back(face);
    }
    scene.forces = {sim::DeadLoad{
        "block", {sim::Selector::HalfSpace{{0.29, 0, 0}, {-1, 0, 0}}, {}}, {100, 0, 0}}};
    sim::Simulation simulation(scene, 1.0 / 24);
    simulation.advance_to(0.5);
    const std::vector<sim::PinRow> pins = simulation.pins();
    for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis) {
            CAPTURE(k, axis);
            CHECK(pins[k].force[axis]
                  == Approx(k == 0 && axis == 0 ? -100 : 0).epsilon(1e-3).margin(1e-2));
        }
}

TEST_CASE("a pin that moves a body evenly pays for damping") {
    // c m v: what no inertia and no stress asks for.
    sim::Scene scene;
    scene.solver.steps = GENERATE(sim::Steps::Implicit, sim::Steps::Bdf2, sim::Steps::Explicit);
    scene.solver.method = sim::Method::Fem;
    scene.solver.dt = 1e-3;
    scene.solver.damping = 10;
    scene.bodies = {tests::soft_block("block", {0, 0, 0}, {0.2, 0.2, 0.2}, 0.1, 1e6)};
    scene.bodies[0].velocity = {2, 0, 0};
    scene.pins = {{"all", "block", {sim::Selector::All{}, {}}, sim::Pin::Velocity{{2, 0, 0}}}};
    sim::Simulation simulation(scene, 1.0 / 24);
    simulation.advance_to(0.1);
    CAPTURE(int(scene.solver.steps));
    CHECK(simulation.pins()[0].force.x()
          == Approx(10 * simulation.stats().total_mass * 2).epsilon(1e-9));
}
