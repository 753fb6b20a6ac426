#include "assets/base/error.h"
#include "sim/simulation.h"
#include "tests/support/bar_scene.h"
#include "tests/support/soft_block.h"
#include "tests/support/squashed_columns.h"
#include "tests/support/threads.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

constexpr double frame_time = 1.0 / 24;

sim::Scene bar(sim::Method method, sim::Steps steps = sim::Steps::Implicit) {
    tests::BarOptions options;
    options.solver.method = method;
    options.solver.steps = steps;
    options.solver.dt = 2e-3;
    return tests::bar_scene(options);
}

const sim::Method all_methods[] = {
    sim::Method::Fem, sim::Method::Enriched, sim::Method::Domains};

/// Between two states of a scene.   [m]
double way_of_probe(const sim::Simulation& from, const sim::Simulation& to) {
    return (to.probes()[0].position - from.probes()[0].position).norm();
}

/// Checks that a new simulation goes on from each frame as `whole` does; returns how deep that was in colliders, in domain
/// edges.
double check_resumes(sim::Simulation& whole,
                     const sim::Scene& scene,
                     double frame_length,
                     int n_frames) {
    double deepest = 0;
    for (int frame = 1; frame <= n_frames; ++frame) {
        sim::Simulation resumed(scene, frame_time);
        resumed.restore(whole.checkpoint());
        whole.advance_to(frame_length * frame);
        resumed.advance_to(frame_length * frame);
        const bool goes_on = whole.checkpoint() == resumed.checkpoint();
        CAPTURE(frame);
        CHECK(goes_on);
        deepest = std::max(deepest, whole.stats().collider_penetration);
    }
    return deepest;
}

enum class Meeting { OfSurfaces, WithItself, OnGrid, OfPoints };
const auto all_meetings = {
    Meeting::OfSurfaces, Meeting::WithItself, Meeting::OnGrid, Meeting::OfPoints};

/// Two cubes n domains wide, of which the left one meets the right one. It may be of snow, and both may be one body: then they
/// are further apart, as neighbours at rest do not meet, and the left one is driven.
sim::Scene meeting(Meeting kind, sim::Steps steps, int n) {
    const int n_apart = kind == Meeting::WithItself ? 3 : 1;
    const double side = 0.3, edge = side / n, apart = n_apart * edge;
    const Vec3 low(-side - apart, 0, 0), size = Vec3::Constant(side),
                                         velocity(4 * n_apart, 0, 0);
    sim::Scene scene;
    scene.solver.steps = steps;
    scene.solver.dt = 1e-3;
    scene.contact.friction = {false, 0.3};
    scene.bodies = {tests::soft_block("left", low, size, edge, 1e6)};
    const assets::Box right{{0, 0, 0}, size};
    if (kind == Meeting::WithItself) {
        scene.solver.method = sim::Method::Fem;  // else they meet by the grid of their body
        const assets::Box left{low, low + size};
        scene.bodies[0].source.geometry = assets::Shape{
            assets::Combination{assets::Combination::Kind::Union, {{left}, {right}}}};
        scene.pins = {{"ram", "left", {left, {}}, sim::Pin::Velocity{velocity}}};
        scene.probes = {{"struck", "left", Vec3(0, side / 2, side / 2)}};
        return scene;
    }
    scene.bodies.push_back(tests::soft_body("right", right, edge, 1e6));
    scene.probes = {{"struck", "right", Vec3(0, side / 2, side / 2)}};
    scene.bodies[0].velocity = velocity;
    if (kind == Meeting::OnGrid)
        scene.contact.mode = sim::Contact::Mode::Grid;
    if (kind == Meeting::OfPoints)
        scene.bodies[0].regions[0].model = sim::Model::Snow;
    return scene;
}

}  // namespace

TEST_CASE("a restored checkpoint goes on to the same bits") {
    const sim::Steps steps = GENERATE(
        sim::Steps::Implicit, sim::Steps::Bdf2, sim::Steps::Explicit, sim::Steps::SemiImplicit);
    for (const sim::Method method : all_methods) {
        const sim::Scene scene = bar(method, steps);
        sim::Simulation whole(scene, frame_time), first(scene, frame_time),
            second(scene, frame_time);
        whole.advance_to(0.05);
        first.advance_to(0.05);
        second.restore(first.checkpoint());
        CHECK(second.time() == first.time());
        whole.advance_to(0.1);
        second.advance_to(0.1);
        const bool goes_on = whole.checkpoint() == second.checkpoint();
        CHECK(goes_on);
        CHECK(way_of_probe(first, whole) > 1e-3);
    }
}

TEST_CASE(
    "a restored checkpoint of bodies whose corners are freed, held and let go goes on to the "
    "same bits") {
    sim::Scene scene = tests::squashed_columns(
        2, GENERATE(sim::Steps::Implicit, sim::Steps::Bdf2, sim::Steps::Explicit));
    scene.solver.enrich.strain = GENERATE(true, false);
    scene.pins[0].until = 0.06;
    sim::Simulation whole(scene, frame_time);
    check_resumes(whole, scene, 0.01, 12);
    CHECK(way_of_probe(sim::Simulation(scene, frame_time), whole) > 0.01);
}

TEST_CASE(
    "a restored checkpoint of a body whose interface passes through the grid goes on to the "
    "same bits") {
    // The grid at rest, where places decide which corners are free, and BDF2 sees others than there are.
    sim::Scene scene = bar(sim::Method::Enriched, sim::Steps::Bdf2);
    scene.contact.mode = sim::Contact::Mode::Grid;
    scene.solver.enrich = {true, false, false, false};
    scene.solver.dt = 5e-3;
    scene.pins.clear();
    scene.forces.clear();
    scene.bodies[0].velocity = {1, 0.5, 0.3};
    scene.bodies[0].spin = {0, 6, 2};
    sim::Simulation whole(scene, frame_time);
    check_resumes(whole, scene, 0.02, 20);
}

TEST_CASE("a restored checkpoint of points goes on to the same bits") {
    const sim::Steps steps =
        GENERATE(sim::Steps::Implicit, sim::Steps::Explicit, sim::Steps::SemiImplicit);
    const sim::Transfer transfer = GENERATE(sim::Transfer::Flip, sim::Transfer::Apic);
    sim::Scene scene = bar(sim::Method::Mpm, steps);
    scene.solver.transfer = transfer;
    scene.bodies[0].regions[1].model = sim::Model::Snow;
    sim::Simulation whole(scene, frame_time), first(scene, frame_time),
        second(scene, frame_time);
    whole.advance_to(0.03);
    first.advance_to(0.03);
    second.restore(first.checkpoint());
    whole.advance_to(0.06);
    second.advance_to(0.06);
    const bool goes_on = whole.checkpoint() == second.checkpoint();
    CHECK(goes_on);
    CHECK(way_of_probe(first, whole) > 1e-3);
}

TEST_CASE("a restored checkpoint of a body in a collider goes on to the same bits") {
    sim::Scene scene;
    scene.solver.steps = GENERATE(sim::Steps::Implicit, sim::Steps::Explicit);
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    scene.solver.dt = 2e-3;
    scene.bodies = {tests::soft_block("cube", {0, 0, 0.02}, Vec3::Constant(0.3), 0.05, 1e5)};
    scene.forces.push_back(sim::Gravity{{0, 0, -10}});
    sim::Collider ground;
    ground.shape = sim::PlaneShape{{0, 0, 0}, {0, 0, 1}};
    scene.colliders.push_back(ground);
    sim::Simulation whole(scene, frame_time);
    CHECK(check_resumes(whole, scene, 0.02, 10) > 0);
}

TEST_CASE("a restored checkpoint of bodies that meet goes on to the same bits") {
    // Lists and watches that last for several steps start anew, and must tell the same.
    const Meeting kind = GENERATE(values(all_meetings));
    const sim::Steps steps = GENERATE(sim::Steps::Implicit, sim::Steps::Explicit);
    CAPTURE(int(kind), int(steps));
    const sim::Scene scene = meeting(kind, steps, 6);
    sim::Simulation whole(scene, frame_time);
    check_resumes(whole, scene, 0.004, 12);
    CHECK(way_of_probe(sim::Simulation(scene, frame_time), whole)
          > 1e-3);  // pushed by the other
}

TEST_CASE("a checkpoint of other bodies, or one that is cut, is refused and changes nothing") {
    const sim::Scene scene = bar(sim::Method::Enriched);
    sim::Simulation simulation(scene, frame_time);
    simulation.advance_to(0.02);
    const std::vector<std::byte> before = simulation.checkpoint();
    std::vector<std::byte> cut = before, longer = before;
    cut.resize(before.size() / 2);
    longer.push_back({});
    sim::Scene finer = scene;
    finer.bodies[0].domain_size /= 2;
    for (const std::vector<std::byte>& other :
         {cut, longer, sim::Simulation(finer, frame_time).checkpoint()}) {
        CHECK_THROWS_AS(simulation.restore(other), std::logic_error);
        const bool is_same = simulation.checkpoint() == before;
        CHECK(is_same);
    }
}

TEST_CASE("a checkpoint that another version of the program wrote is told") {
    const sim::Scene scene = bar(sim::Method::Enriched, sim::Steps::Explicit);
    const std::vector<std::byte> now = sim::Simulation(scene, frame_time).checkpoint();
    CHECK(sim::Simulation::is_readable(now));
    std::vector<std::byte> other = now;
    other[6] ^= std::byte{1};  // the number of its format
    CHECK_FALSE(sim::Simulation::is_readable(other));
    other.assign(now.begin() + 8, now.end());  // of before there was one: begins with the time
    CHECK_FALSE(sim::Simulation::is_readable(other));
    CHECK_FALSE(sim::Simulation::is_readable({}));
}

TEST_CASE("one thread and two give the same bits") {
    tests::BarOptions options;
    options.n_domains = {60, 12, 12};  // several bricks, cells and chunks
    options.segment_ends = {20, 40};
    options.domain_size = 0.0125;
    options.solver.dt = 2e-3;
    options.solver.method = GENERATE(sim::Method::Enriched, sim::Method::Mpm);
    const auto run = [&] {
        sim::Simulation simulation(tests::bar_scene(options), frame_time);
        simulation.advance_to(0.02);
        return simulation.checkpoint();
    };
    const bool is_same = tests::on_threads(1, run) == tests::on_threads(2, run);
    CHECK(is_same);
}

TEST_CASE("one thread and two give the same bits where bodies meet") {
    const Meeting kind = GENERATE(values(all_meetings));
    CAPTURE(int(kind));
    const sim::Scene scene = meeting(kind, sim::Steps::Explicit, 16);  // several chunks
    const auto run = [&] {
        sim::Simulation simulation(scene, frame_time);
        simulation.advance_to(0.005);
        CHECK(way_of_probe(sim::Simulation(scene, frame_time), simulation) > 1e-4);
        return simulation.checkpoint();
    };
    const bool is_same = tests::on_threads(1, run) == tests::on_threads(2, run);
    CHECK(is_same);
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

TEST_CASE("a step that fails is halved, told, and does no harm to the result") {
    // A pin that turns the end of the bar far within a step squashes domains flat.
    tests::BarOptions options;
    options.n_domains = {6, 2, 2};
    options.segment_ends = {2, 4};
    options.solver.method = sim::Method::Fem;
    options.solver.dt = 0.04;
    sim::Scene scene = tests::bar_scene(options);
    sim::Pin grip = scene.pins[0];
    grip.name = "grip";
    grip.select.is = sim::Selector::HalfSpace{{0.149, 0, 0}, {-1, 0, 0}};
    grip.moves = sim::Pin::Velocity{{-3.5, 0, 0}};  // 0.14 m in the step, of 0.15 m
    grip.until = 0.03;
    scene.pins.push_back(grip);
    sim::Simulation coarse(scene, frame_time);
    coarse.advance_to(0.04);
    CHECK_FALSE(coarse.failures().empty());
    const std::string told = coarse.failures().front();
    CHECK_THAT(told, Catch::Contains("body \"bar\", region \"") && Catch::Contains(", at ("));
    CHECK_THAT(
        told,
        Catch::Contains("likely cause: pins or speeds squash domains flat within one step; "
                        "try --set solver.dt=0.01"));
    double x = 0, y = 0, z = 0, J = 1;  // of the worst domain, in the bar
    const std::string place = told.substr(told.find("at (") + 4);
    REQUIRE(std::sscanf(place.c_str(), "%lg, %lg, %lg), J = %lg", &x, &y, &z, &J) == 4);
    CHECK((x > -0.02 && x < 0.17 && std::abs(y) < 0.05 && std::abs(z) < 0.05));
    CHECK(J < 0.5);
    CHECK(coarse.stats().steps > 1);

    // What the halves have led to is what short steps lead to, but for the damping of long ones.
    scene.solver.dt = 2e-3;
    sim::Simulation fine(scene, frame_time);
    coarse.advance_to(0.2);
    fine.advance_to(0.2);
    CHECK(std::isfinite(coarse.stats().kinetic_energy));
    CHECK(coarse.stats().smallest_J > 0);
    CHECK(way_of_probe(fine, coarse) < 0.1 * 0.15);
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

TEST_CASE(
    "a watch is asked on the way of a solve, and a step that it gives up leaves no trace") {
    const sim::Scene scene =
        bar(sim::Method::Fem, GENERATE(sim::Steps::Implicit, sim::Steps::Static));
    sim::Simulation simulation(scene, frame_time);
    const double end = scene.solver.steps == sim::Steps::Static ? 1 : *scene.solver.dt;
    const std::vector<std::byte> before = simulation.checkpoint();
    sim::Simulation whole(scene, frame_time);
    int n_asked = 0;
    whole.advance_to(end, [&](double) { ++n_asked; });
    CHECK(n_asked == whole.stats().newton_iterations + whole.stats().steps);
    CHECK_THROWS_AS(
        simulation.advance_to(end, [](double) { throw std::runtime_error("stop"); }),
        std::runtime_error);
    simulation.restore(before);
    simulation.advance_to(end);
    const bool is_same = simulation.checkpoint() == whole.checkpoint();
    CHECK(is_same);
}
