// Explicit steps of several drifts under one map.
#include "sim/simulation.h"
#include "tests/support/bar_scene.h"
#include "tests/support/box_body.h"
#include "tests/support/soft_block.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

namespace {

constexpr double frame = 9e-3;          // [s]
constexpr double longest = frame / 8;   // dt: there is time for two drifts in it
constexpr int n_drifts = 16;            // in a frame: of 0.56 ms, the bar is stable at 0.6
constexpr int n_drifts_of_points = 22;  // of 0.41 ms, the bar is stable at 0.43

tests::BarOptions bar(sim::Method method, double dt) {
    tests::BarOptions options;
    options.solver.method = method;
    options.solver.steps = sim::Steps::Explicit;
    options.solver.dt = dt;
    return options;
}

constexpr double side = 0.3, duration = 0.3;  // of a block and of its pressing

/// A block whose top is brought to `factor` of its height, and let go.
sim::Scene pressed_block(sim::Method method, double factor) {
    sim::Scene scene;
    scene.solver = bar(method, 10e-3).solver;
    scene.bodies = {tests::soft_block("block", {0, 0, 0}, Vec3::Constant(side), side / 6, 1e5)};
    sim::Pin top = tests::foot_of("block");
    top.name = "top";
    top.select.is = sim::Selector::HalfSpace{{0, 0, 0.999 * side}, {0, 0, -1}};
    top.moves = sim::Pin::Velocity{{0, 0, (factor - 1) * side / duration}};
    top.until = duration;
    scene.pins = {tests::foot_of("block"), top};
    return scene;
}

}  // namespace

TEST_CASE(
    "a step of many drifts moves finite elements as many steps do, and pins pull as their mean",
    "[drifts]") {
    sim::Scene scene = tests::bar_scene(bar(sim::Method::Fem, longest));
    scene.solver.damping = 3;
    sim::Simulation longer(scene, frame), shorter(scene, frame);
    for (int k = 1; k <= 5; ++k) {
        longer.advance_to(frame * k);
        const int n = n_drifts / longer.stats().steps;  // of the last step
        REQUIRE(n * longer.stats().steps == n_drifts);
        REQUIRE(n > 1);
        Vec3 pull{0, 0, 0};
        for (int drift = 1; drift <= n_drifts; ++drift) {
            shorter.advance_to(frame * (k - 1 + double(drift) / n_drifts));
            if (drift > n_drifts - n)
                pull += shorter.pins()[0].force / n;
        }
        const Vec3 tip = shorter.probes()[0].position;
        CHECK((longer.probes()[0].position - tip).norm() < 1e-11);
        CHECK((longer.pins()[0].force - pull).norm() < 1e-6 * pull.norm());
        CHECK(longer.stats().kinetic_energy
              == Approx(shorter.stats().kinetic_energy).epsilon(1e-9));
    }
}

TEST_CASE("pins pull at points in a step of many drifts as in the mean of many steps",
          "[drifts]") {
    sim::Scene scene = tests::bar_scene(bar(sim::Method::Mpm, longest));
    scene.solver.kernel = sim::Kernel::Cubic;
    scene.solver.damping = 3;
    sim::Simulation longer(scene, frame), shorter(scene, frame);
    for (int k = 1; k <= 5; ++k) {
        longer.advance_to(frame * k);
        const int n = n_drifts_of_points / longer.stats().steps;  // of the last step
        REQUIRE(n * longer.stats().steps == n_drifts_of_points);
        REQUIRE(n > 1);
        Vec3 pull{0, 0, 0};
        for (int drift = 1; drift <= n_drifts_of_points; ++drift) {
            shorter.advance_to(frame * (k - 1 + double(drift) / n_drifts_of_points));
            if (drift > n_drifts_of_points - n)
                pull += shorter.pins()[0].force / n;
        }
        CAPTURE(k, pull.transpose(), longer.pins()[0].force.transpose());
        // The bar itself swings a little otherwise, see below.
        CHECK((longer.pins()[0].force - pull).norm() < 0.1 * pull.norm());
    }
}

TEST_CASE("under one map for many drifts a bar swings as with a map for each drift",
          "[drifts]") {
    // The map is that of where the step begins: its age costs less than the map itself.
    const sim::Method method =
        GENERATE(sim::Method::Enriched, sim::Method::Domains, sim::Method::Mpm);
    const double swing = 0.15;  // of the tip, down and up again [m]
    sim::Scene scene = tests::bar_scene(bar(method, longest));
    if (method == sim::Method::Mpm)
        scene.solver.kernel = sim::Kernel::Cubic;
    sim::Simulation longer(scene, frame), shorter(scene, frame);
    const int n = method == sim::Method::Mpm ? n_drifts_of_points : n_drifts;
    int n_of_longer = 0, n_of_shorter = 0;
    for (int k = 1; k <= 40; ++k) {
        longer.advance_to(frame * k);
        n_of_longer += longer.stats().steps;
        for (int drift = 1; drift <= n; ++drift) {
            shorter.advance_to(frame * (k - 1 + double(drift) / n));
            n_of_shorter += shorter.stats().steps;
        }
        const Vec3 by_longer = longer.probes()[0].position,
                   by_shorter = shorter.probes()[0].position;
        CAPTURE(k, by_longer.transpose(), by_shorter.transpose());
        // Points lose a part of their swing with every map, so more by shorter steps.
        CHECK((by_longer - by_shorter).norm()
              < (method == sim::Method::Mpm ? 0.02 : 0.01) * swing);
    }
    CHECK(n_of_shorter == 40 * n);
    CHECK(n_of_longer < n_of_shorter / 6);
}

TEST_CASE("a pin that turns leads its corners by chords of dt under any map", "[drifts]") {
    // A chord of angle a is shorter than its arc by a²/24 of it: from I w²/2 it takes a²/12.
    sim::Scene scene = tests::bar_scene(bar(sim::Method::Fem, longest));
    scene.forces.clear();
    const double rate = 2;  // [1/s]
    REQUIRE(scene.pins.size() == 1);
    scene.pins[0].select = {sim::Selector::HalfSpace{{9, 0, 0}, {1, 0, 0}}, {}};  // all of it
    scene.pins[0].moves = sim::Pin::Spin{{0, 0, 1}, {0, 0, 0}, rate};
    scene.bodies[0].spin = {0, 0, rate};
    scene.bodies[0].velocity = {0, rate * std::get<Vec3>(scene.probes[0].at).x() / 2, 0};
    sim::Simulation simulation(scene, frame);
    const double turning = simulation.stats().kinetic_energy;
    simulation.advance_to(frame);
    const double lost = 1 - simulation.stats().kinetic_energy / turning;
    CHECK(lost > 0);
    CHECK(lost < std::pow(rate * longest, 2) / 12);
}

TEST_CASE("a pin lets go in time though a map could serve longer", "[drifts]") {
    // Released in the middle of what a step could be, the bar falls freely from then on: of 8 dt, or of dt if the pin turns.
    const bool turns = GENERATE(false, true);
    CAPTURE(turns);
    const double released = 0.28 * frame, g = 10;
    sim::Scene scene = tests::bar_scene(bar(sim::Method::Fem, longest));
    scene.forces = {sim::Gravity{{0, 0, -g}}};
    REQUIRE(scene.pins.size() == 1);
    scene.pins[0].select = {sim::Selector::HalfSpace{{9, 0, 0}, {1, 0, 0}}, {}};  // all of it
    scene.pins[0].until = released;
    if (turns)
        scene.pins[0].moves = sim::Pin::Spin{{0, 0, 1}, {0, 0, 0}, 1};
    sim::Simulation simulation(scene, frame);
    const Vec3 start = simulation.probes()[0].position;
    simulation.advance_to(frame);
    const double way = start.z() - simulation.probes()[0].position.z();
    // In the drift that begins before.
    const double drift = 0.6e-3;
    CHECK(way <= g / 2 * std::pow(frame - released, 2));
    CHECK(way >= g / 2 * std::pow(frame - released - drift, 2));
}

TEST_CASE("steps of many drifts bounce on the ground as single drifts do", "[drifts]") {
    // Every drift meets colliders. A cube of 1 MPa is stable at 0.9 ms; it falls by 0.2 m and sticks to nothing.
    const sim::Method method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    const double moment = 0.006;  // [s]

    struct Course {
        double deepest = 0, rebound = 0;  // [domain edges], [m]
        int steps = 0;
    };

    const auto fall = [&](int stops_per_moment) {
        sim::Scene scene;
        scene.solver = bar(method, moment).solver;
        scene.bodies = {tests::soft_block("cube", {0, 0, 0.2}, Vec3::Constant(0.3), 0.05, 1e6)};
        scene.forces.push_back(sim::Gravity{{0, 0, -10}});
        sim::Collider ground;
        ground.shape = sim::PlaneShape{{0, 0, 0}, {0, 0, 1}};
        scene.colliders.push_back(ground);
        scene.probes = {{"cube", "cube", std::string("all")}};
        sim::Simulation simulation(scene, frame);
        Course course;
        for (int k = 1; k <= 60 * stops_per_moment; ++k) {
            simulation.advance_to(moment * k / stops_per_moment);
            const sim::Stats stats = simulation.stats();
            course.deepest = std::max(course.deepest, stats.collider_penetration);
            course.steps += stats.steps;
            if (k > 40 * stops_per_moment)
                course.rebound = std::max(course.rebound, simulation.probes()[0].position.z());
        }
        return course;
    };
    const Course by_short = fall(12), by_long = fall(1);
    CAPTURE(int(method),
            by_short.rebound,
            by_long.rebound,
            by_short.deepest,
            by_long.deepest,
            by_long.steps);
    CHECK(by_long.steps < by_short.steps / 4);
    CHECK(by_long.deepest < 0.02);
    CHECK(by_short.rebound > 0.2);
    CHECK(by_long.rebound == Approx(by_short.rebound).epsilon(0.02));
}

TEST_CASE("bodies meet on the grid in every drift under one map", "[drifts]") {
    // A cube, of domains or points, falls on one that is held at its foot, and stops as it does under a map for each drift.
    const sim::Method method =
        GENERATE(sim::Method::Fem, sim::Method::Domains, sim::Method::Mpm);
    const double moment = 0.006, side = 0.3, speed = 2;  // [s], [m], [m/s]

    struct Course {
        double lowest = 1e9;  // of the centre of the one that falls [m]
        Vec3 momentum{0, 0, 0};
        int steps = 0;
    };

    const auto fall = [&](sim::Method moved_by, int stops_per_moment) {
        sim::Scene scene;
        scene.solver = bar(moved_by, moment).solver;
        scene.solver.kernel = sim::Kernel::Quadratic;  // of points
        scene.contact.mode = sim::Contact::Mode::Grid;
        const Vec3 size = Vec3::Constant(side);
        scene.bodies = {tests::soft_block("below", {0, 0, 0}, size, 0.05, 1e6),
                        tests::soft_block("above", {0.05, 0.05, side + 0.01}, size, 0.05, 1e6)};
        scene.bodies[1].velocity = {0, 0, -speed};
        scene.pins = {tests::foot_of("below")};
        scene.probes = {{"above", "above", std::string("all")}};
        sim::Simulation simulation(scene, frame);
        Course course;
        for (int k = 1; k <= 10 * stops_per_moment; ++k) {
            simulation.advance_to(moment * k / stops_per_moment);
            course.lowest = std::min(course.lowest, simulation.probes()[0].position.z());
            course.momentum = simulation.stats().linear_momentum;
            course.steps += simulation.stats().steps;
        }
        return course;
    };
    const Course by_short = fall(method, 12), by_long = fall(method, 1),
                 by_elements = fall(sim::Method::Fem, 12);
    CAPTURE(int(method),
            by_short.lowest,
            by_long.lowest,
            by_short.momentum.transpose(),
            by_long.momentum.transpose(),
            by_short.steps,
            by_long.steps);
    CHECK(by_long.steps < by_short.steps / 3);
    CHECK(by_short.momentum.z() > 0);  // it has bounced
    CHECK(by_long.lowest == Approx(by_short.lowest).margin(0.02 * side));
    // What corners of domains and points lose to the grid they lose with every map.
    const double least = method == sim::Method::Fem ? 0.9 : 1;
    CHECK(by_long.momentum.z() > least * by_short.momentum.z());
    CHECK(by_long.momentum.z() < by_elements.momentum.z());
}

TEST_CASE("cubes that meet in the middle of a long explicit step stay out of each other",
          "[drifts]") {
    const double speed = GENERATE(1, 5, 10), side = 0.3;
    const sim::Method method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    CAPTURE(speed, int(method));
    sim::Scene scene;
    scene.solver = bar(method, 8e-3).solver;
    const Vec3 size = Vec3::Constant(side);
    scene.bodies = {tests::soft_block("left", {-side - 0.02, 0, 0}, size, 0.05, 1e6),
                    tests::soft_block("right", {0.02, 0.12, 0.12}, size, 0.05, 1e6)};
    scene.bodies[0].velocity = {speed / 2, 0, 0};
    scene.bodies[1].velocity = {-speed / 2, 0, 0};
    sim::Simulation simulation(scene, frame);
    const sim::Stats start = simulation.stats();
    double deepest = 0;
    for (int k = 1; k <= 40; ++k) {
        simulation.advance_to((0.2 / speed + 0.04) * k / 40);
        const sim::Stats now = simulation.stats();
        deepest = std::max(deepest, now.penetration);
        CHECK((now.linear_momentum - start.linear_momentum).norm()
              < 1e-12 * start.total_mass * speed);
        // What velocity Verlet keeps differs by ripples from the energy at the ends of steps.
        CHECK(tests::energy(now) < tests::energy(start) * (1 + 1e-3));
    }
    CHECK(tests::energy(simulation.stats()) < 0.99 * tests::energy(start));  // they have met
    CHECK(deepest < 0.02);
}

TEST_CASE("a block that is pressed or pulled far, slowly, and let go gains no energy",
          "[drifts]") {
    // It stiffens, by more than twice the square of its highest frequency at rest: drifts must get shorter in time. What
    // velocity Verlet keeps is not quite the energy: near the limit that ripples by some thousandths.
    const double factor = GENERATE(0.7, 0.5, 2.0);
    const sim::Model model = GENERATE(sim::Model::NeoHookean, sim::Model::StableNeoHookean);
    const sim::Method method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    CAPTURE(factor, int(model), int(method));
    sim::Scene scene = pressed_block(method, factor);
    scene.bodies[0].regions[0].model = model;
    sim::Simulation simulation(scene, frame);
    simulation.advance_to(duration);
    const double stored = tests::energy(simulation.stats());
    for (int k = 1; k <= 30; ++k) {
        simulation.advance_to(duration * (1 + k / 30.0));
        CHECK(tests::energy(simulation.stats()) < 1.01 * stored);
    }
    CHECK(tests::energy(simulation.stats()) > 0.9 * stored);
}

TEST_CASE("drifts that follow how stiff a body is as it swings do not heat it", "[drifts]") {
    // Both halves together swing thirty times, pressed so far that the longest stable drift is another one all the time.
    const sim::Model model = GENERATE(sim::Model::NeoHookean, sim::Model::StableNeoHookean);
    const sim::Method method =
        GENERATE(sim::Method::Fem, sim::Method::Enriched, sim::Method::Domains);
    CAPTURE(int(model), int(method));
    sim::Scene scene = pressed_block(method, 0.7);
    scene.bodies[0].regions.push_back(
        tests::region("softer", tests::behind({0, 0, side / 2}, Vec3(0, 0, 1)), 0.5e5));
    for (sim::Region& region : scene.bodies[0].regions)
        region.model = model;
    sim::Simulation simulation(scene, frame);
    simulation.advance_to(duration);
    const double stored = tests::energy(simulation.stats());
    for (int k = 1; k <= 30; ++k) {
        simulation.advance_to(duration + k / 24.0);
        CHECK(tests::energy(simulation.stats()) < 1.01 * stored);
    }
    CHECK(tests::energy(simulation.stats()) > 0.95 * stored);
}

TEST_CASE("a body that is flung at another within a long explicit step stays out of it",
          "[drifts]") {
    // From rest, 0.3 domains away, by 0.5 domains in a step that speeds at its start do not make shorter.
    const double duration = 8.5e-3, edge = 0.05, side = 0.3, gap = 0.3 * edge;
    sim::Scene scene;
    scene.solver = bar(sim::Method::Fem, duration).solver;
    const Vec3 size = Vec3::Constant(side);
    scene.bodies = {tests::soft_block("flung", {-side - gap, 0, 0}, size, edge, 1e6),
                    tests::soft_block("still", {0, 0, 0}, size, edge, 1e6)};
    const double mass = 1000 * std::pow(side, 3), acceleration = edge / std::pow(duration, 2);
    scene.forces.push_back(
        sim::DeadLoad{"flung", {sim::Selector::All{}, {}}, {mass * acceleration, 0, 0}});
    sim::Simulation simulation(scene, frame);
    simulation.advance_to(duration);
    CHECK(simulation.stats().gap < 0.01);  // they have met
    CHECK(simulation.stats().penetration < 0.02);
}
