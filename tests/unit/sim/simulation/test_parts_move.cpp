// Parts of one body that are not connected inside a domain move apart.
#include "sim/simulation.h"
#include "tests/support/block_mesh.h"
#include "tests/support/box_body.h"
#include "tests/unit/assets/generators/obj_file.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace {

constexpr double s = 0.1;

/// A fork whose joint is held and whose upper prong is pulled up at its end, in equilibrium.
sim::Scene pulled_fork(const ObjFile& file, sim::Method method, sim::Steps steps, int n = 4) {
    sim::Scene scene;
    sim::Body body = tests::body_of(assets::Box{}, s);
    body.name = "fork";
    body.source = file.source();
    scene.bodies = {body};
    scene.solver.method = method;
    scene.solver.steps = steps;
    scene.pins.push_back(
        {"joint", "fork", tests::behind({2 * s, 0, 0}, {1, 0, 0}), sim::Pin::Fixed{}});
    sim::DeadLoad pull;
    pull.body = "fork";
    pull.select = {assets::Box{s * Vec3(n + 1.5, -1, 0.5), s * Vec3(n + 3, 2, 2)}, {}};
    pull.total = Vec3(0, 0, 1);
    scene.forces.push_back(pull);
    scene.probes.push_back({"upper", "fork", s * Vec3(n + 1.9, 0.5, 0.9)});
    scene.probes.push_back({"lower", "fork", s * Vec3(n + 1.9, 0.5, 0.1)});
    return scene;
}

}  // namespace

TEST_CASE("pulling one prong of a fork leaves the other where it is") {
    const ObjFile file("supple_pulled_fork", tests::fork(s, 4));
    const auto steps = GENERATE(sim::Steps::Static, sim::Steps::Implicit);
    sim::Simulation simulation(pulled_fork(file, sim::Method::Fem, steps), 1.0 / 24);
    if (steps == sim::Steps::Implicit)
        simulation.advance_to(1.0 / 24);
    const std::vector<sim::ProbeRow> probes = simulation.probes();
    CHECK(probes[0].position.z() - 0.9 * s > 1e-3 * s);
    CHECK((probes[1].position - s * Vec3(5.9, 0.5, 0.1)).norm() < 1e-12 * s);
}

TEST_CASE(
    "pulling one prong that the grid moves bends the other at its root alone, in the same "
    "cells") {
    // They share the nodes around the joint: the other prong turns with its root, without bending further on.
    const int n = 12;
    const ObjFile file("supple_pulled_fork", tests::fork(s, n));
    for (const auto steps : {sim::Steps::Implicit, sim::Steps::Explicit}) {
        sim::Scene scene = pulled_fork(file, sim::Method::Domains, steps, n);
        scene.solver.damping = 20;
        sim::Simulation simulation(scene, 1.0 / 24);
        simulation.advance_to(1);
        const std::vector<sim::ProbeRow> probes = simulation.probes();
        const double upper = probes[0].position.z() - 0.9 * s,
                     lower = probes[1].position.z() - 0.1 * s;
        CAPTURE(upper, lower);
        CHECK(upper > 0.01 * s);
        CHECK(std::abs(lower) < 0.4 * upper);
    }
}
