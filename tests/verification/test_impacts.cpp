// Bodies against each other by their surfaces: momentum, energy, and how far they get into each other.
#include "tests/support/soft_block.h"
#include "tests/support/squashed_columns.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace {

constexpr double frame_time = 1.0 / 24;
// Of the cubes [m], [m], [Pa]: waves run at 10 m/s.
constexpr double side = 0.3, edge = 0.05, soft = 1e5;

/// Two cubes 2 cm apart that meet along x at `speed`, one `shift` aside in y and z.
sim::Scene two_cubes(double speed, double shift) {
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    const Vec3 size = Vec3::Constant(side);
    scene.bodies = {tests::soft_block("left", {-side - 0.01, 0, 0}, size, edge, soft),
                    tests::soft_block("right", {0.01, shift, shift}, size, edge, soft)};
    scene.bodies[0].velocity = {speed / 2, 0.1, 0};
    scene.bodies[1].velocity = {-speed / 2, 0.1, 0};
    scene.probes = {{"left", "left", std::string("all")},
                    {"right", "right", std::string("all")}};
    return scene;
}

/// What an impact did, over frames.
struct Course {
    double deepest = 0;  // penetration [domain edges]
    double lowest = 0;   // energy kept, of that at the start
    // Of the energy over what it was in any frame before, of that at the start.
    double worst_rise = 0;
    double highest = 0;                            // energy, of that at the start
    double momentum_error = 0, angular_error = 0;  // of m speed/2, of that times the side
    // Times at which other domains of the first body were enriched than before.
    int n_changes = 0;
};

Course run(const sim::Scene& scene, double speed, double duration, int n_frames) {
    sim::Simulation simulation(scene, frame_time);
    const sim::Stats start = simulation.stats();
    const double momentum = start.total_mass * speed / 4;
    Course course;
    double least = 1;
    int enriched = tests::n_enriched(simulation);
    for (int k = 1; k <= n_frames; ++k) {
        simulation.advance_to(duration * k / n_frames);
        const int enriched_now = tests::n_enriched(simulation);
        course.n_changes += enriched_now != enriched;
        enriched = enriched_now;
        const sim::Stats now = simulation.stats();
        const double kept = tests::energy(now) / tests::energy(start);
        course.worst_rise = std::max(course.worst_rise, kept - least);
        course.highest = std::max(course.highest, kept);
        least = std::min(least, kept);
        course.deepest = std::max(course.deepest, now.penetration);
        course.momentum_error =
            std::max(course.momentum_error,
                     (now.linear_momentum - start.linear_momentum).norm() / momentum);
        course.angular_error = std::max(
            course.angular_error,
            (now.angular_momentum - start.angular_momentum).norm() / (momentum * side));
        if (scene.solver.steps != sim::Steps::SemiImplicit)
            CHECK(simulation.failures().empty());
    }
    course.lowest = least;
    return course;
}

}  // namespace

TEST_CASE(
    "two cubes that meet keep their momentum, gain no energy, and stay out of each other") {
    struct Impact {
        double speed, shift, dt;
    };

    // Aligned and shifted by 2.4 domains, slow and as fast as waves, by short and long steps, each way of stepping; every
    // step is looked at.
    const Impact impact = GENERATE(Impact{2, 0, 1e-3},
                                   Impact{2, 0.12, 4e-3},
                                   Impact{10, 0, 4e-3},
                                   Impact{10, 0.12, 0.5e-3},
                                   Impact{10, 0.12, 1e-3},
                                   Impact{10, 0.12, 4e-3});
    sim::Scene scene = two_cubes(impact.speed, impact.shift);
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    scene.solver.steps = GENERATE(sim::Steps::Implicit, sim::Steps::Bdf2, sim::Steps::Explicit);
    scene.solver.dt = impact.dt;
    CAPTURE(impact.speed, impact.shift, impact.dt);
    CAPTURE(int(scene.solver.method), int(scene.solver.steps));
    const double duration = 0.2 / impact.speed + 0.06;
    const Course course =
        run(scene, impact.speed, duration, static_cast<int>(std::lround(duration / impact.dt)));
    CHECK(course.momentum_error < 1e-12);
    CHECK(course.angular_error < 0.01);  // depths are linear in the corners for a step
    CHECK(course.highest < 1 + 1e-6);
    // What velocity Verlet keeps is not the energy itself, but one that differs where modes swing fast.
    if (scene.solver.steps != sim::Steps::Explicit)
        CHECK(course.worst_rise < 1e-6);
    CHECK(course.deepest < 0.02);
    CHECK(course.lowest < 0.99);  // they have met
}

TEST_CASE("cubes that meet by one linearised solve a step keep momentum, and gain no energy") {
    // Where one solve is not enough the step is halved; what it leaves of a depth is more than Newton's method does.
    const double dt = GENERATE(1e-3, 4e-3);
    sim::Scene scene = two_cubes(10, 0.12);
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    scene.solver.steps = sim::Steps::SemiImplicit;
    scene.solver.dt = dt;
    CAPTURE(dt, int(scene.solver.method));
    const Course course = run(scene, 10, 0.08, static_cast<int>(std::lround(0.08 / dt)));
    CHECK(course.momentum_error < 1e-12);
    CHECK(course.highest < 1 + 1e-6);
    CHECK(course.deepest < 0.02);
    CHECK(course.lowest < 0.99);
}

TEST_CASE("cubes whose corners the grid moves stay out of each other by explicit steps too") {
    // The map lets a part of an impulse on slaved corners through: what it keeps back must not be left as a depth.
    struct Impact {
        double speed, shift, young_modulus;
    };

    const Impact impact = GENERATE(Impact{1, 0.12, soft},
                                   Impact{3, 0, 2 * soft},
                                   Impact{3, 0.13, 2 * soft},
                                   Impact{10, 0.12, 2 * soft},
                                   Impact{10, 0.25, soft});
    CAPTURE(impact.speed, impact.shift, impact.young_modulus);
    sim::Scene scene = two_cubes(impact.speed, impact.shift);
    scene.solver.method = GENERATE(sim::Method::Domains, sim::Method::Fem);
    scene.solver.steps = sim::Steps::Explicit;
    scene.solver.dt = 1e-3;
    for (sim::Body& body : scene.bodies)
        body.regions[0].young_modulus = impact.young_modulus;
    const Course course = run(scene, impact.speed, 0.25, 25);
    CHECK(course.momentum_error < 1e-12);
    CHECK(course.highest < 1 + 1e-6);
    CHECK(course.deepest < 0.02);
    CHECK(course.lowest < 0.99);
}

TEST_CASE(
    "a soft cube comes to rest on another by explicit steps, less than 1% of a domain in it") {
    const double height = 0.15;
    sim::Scene scene;
    scene.solver.method = GENERATE(sim::Method::Domains, sim::Method::Fem);
    CAPTURE(int(scene.solver.method));
    scene.solver.steps = sim::Steps::Explicit;
    scene.solver.damping = 10;
    scene.contact.friction = {false, 0.3};
    scene.forces.push_back(sim::Gravity{{0, 0, -10}});
    scene.bodies = {
        tests::soft_block("lower", {0, 0, 0}, Vec3::Constant(side), edge, soft),
        tests::soft_block(
            "upper", {0.09, 0.03, side + 0.01}, Vec3::Constant(height), edge, soft)};
    scene.pins = {tests::foot_of("lower")};
    scene.probes = {{"upper", "upper", std::string("all")}};
    sim::Simulation simulation(scene, frame_time);
    double deepest = 0, before = 0, height_now = 0;
    for (int k = 1; k <= 12; ++k) {
        simulation.advance_to(0.1 * k);
        deepest = std::max(deepest, simulation.stats().penetration);
        before = height_now;
        height_now = simulation.probes()[0].position.z();
    }
    CHECK(deepest < 0.02);
    CHECK(simulation.stats().penetration < 0.01);
    // Their velocities hold the half of a kick that contact takes at the start of the next step: rest is told by place.
    CHECK(std::abs(height_now - before) < 1e-3 * edge);
    // The lower sinks by rho g L²/2E under its own weight and rho g h³/(L E) under the upper, 4.8 mm, and some more where
    // it is pressed; the upper by 0.6 mm at its middle.
    const double sunk = side + height / 2 - height_now;
    CHECK(sunk > 0.0054);
    CHECK(sunk < 1.5 * 0.0054);
}

TEST_CASE("cubes that meet at 20 m/s bounce, or go past each other, but not through") {
    // Two thirds of the speed of waves; aligned also twice of it, which crushes domains.
    struct Impact {
        double shift, young_modulus;
    };

    const Impact impact = GENERATE(Impact{0, 1e6}, Impact{0.05, 1e6}, Impact{0, soft});
    sim::Scene scene = two_cubes(20, impact.shift);
    scene.solver.dt = 1e-3;
    scene.solver.steps = GENERATE(sim::Steps::Implicit, sim::Steps::Explicit);
    scene.solver.method = GENERATE(sim::Method::Fem, sim::Method::Domains);
    for (sim::Body& body : scene.bodies) {
        body.regions[0].young_modulus = impact.young_modulus;
        body.domain_size = side / 4;
    }
    CAPTURE(impact.shift, impact.young_modulus, int(scene.solver.steps));
    sim::Simulation simulation(scene, frame_time);
    const double start = tests::energy(simulation.stats());
    for (int k = 1; k <= 20; ++k) {
        simulation.advance_to(5e-3 * k);
        const auto probes = simulation.probes();
        CHECK(probes[0].position.x() < probes[1].position.x());
        CHECK(tests::energy(simulation.stats()) < start * (1 + 1e-6));
    }
    const auto probes = simulation.probes();
    CHECK(probes[1].position.x() - probes[0].position.x() > side);  // they have parted
}

TEST_CASE("a ball of 20 m/s does not pass through a plate of 0.3 domains") {
    const double thickness = 0.3 * edge;
    sim::Scene scene;
    scene.solver.method = sim::Method::Fem;
    scene.solver.dt = 1e-3;
    scene.bodies.push_back(
        tests::soft_block("plate", {-0.2, -0.2, 0}, {0.4, 0.4, thickness}, edge, 1e6));
    scene.bodies.push_back(
        tests::soft_body("ball", assets::Sphere{{0.01, 0.02, 0.15}, 0.1}, edge, 1e6));
    scene.bodies[1].velocity = {0, 0, -20};
    for (const double x : {-1.0, 1.0}) {
        sim::Pin rim;
        rim.name = x < 0 ? "left" : "right";
        rim.body = "plate";
        rim.select.is = sim::Selector::HalfSpace{{0.16 * x, 0, 0}, {-x, 0, 0}};
        scene.pins.push_back(rim);
    }
    scene.probes = {{"ball", "ball", std::string("all")},
                    {"plate", "plate", Vec3(0, 0, thickness)}};
    sim::Simulation simulation(scene, frame_time);
    double deepest = 0;
    for (int k = 1; k <= 20; ++k) {
        simulation.advance_to(2e-3 * k);
        const auto probes = simulation.probes();
        REQUIRE(probes[0].position.z() > probes[1].position.z());
        deepest = std::max(deepest, simulation.stats().penetration);
    }
    CHECK(deepest < 0.02);
}

TEST_CASE("layered cubes keep momentum and gain no energy while corners turn free and slaved") {
    // A stiff layer in the middle of each. By places: they drift across a grid at rest, so that other cells hold the interface in
    // turn. By strain: soft layers are squashed and recover.
    struct Way {
        sim::EnrichmentCriteria enrich;
        sim::Transfer transfer;
        double speed;
    };

    const Way way = GENERATE(
        Way{{.interface = true, .thin = false}, sim::Transfer::Apic, 2},
        Way{{.interface = false, .thin = false, .mixed_cell = true}, sim::Transfer::Apic, 2},
        Way{{.interface = false, .thin = false, .strain = true}, sim::Transfer::Flip, 8});
    sim::Scene scene = two_cubes(way.speed, 0.06);
    scene.solver.dt = 1e-3;
    scene.solver.method = sim::Method::Enriched;
    scene.solver.transfer = way.transfer;
    scene.solver.steps = GENERATE(sim::Steps::Implicit, sim::Steps::Explicit);
    scene.solver.enrich = way.enrich;
    for (sim::Body& body : scene.bodies) {
        const double x = body.name == "left" ? -0.21 : 0.11;
        sim::Region layer = body.regions[0];
        layer.name = "layer";
        layer.young_modulus = 10 * soft;
        layer.select.is = assets::Box{{x, -1, -1}, {x + 0.1, 1, 1}};
        body.regions.push_back(layer);
        body.velocity.y() = 0.3;
    }
    CAPTURE(int(scene.solver.steps), way.enrich.mixed_cell, way.enrich.strain);
    const Course course = run(scene, way.speed, 0.4 / way.speed, 20);
    CHECK(course.n_changes > 3);
    CHECK(course.momentum_error < 1e-12);
    CHECK(course.highest < 1 + 1e-6);
    if (scene.solver.steps != sim::Steps::Explicit)
        CHECK(course.worst_rise < 1e-6);
    CHECK(course.deepest < 0.02);
    CHECK(course.lowest < 0.99);
}
