// Experiments of [Z18] on bodies of several parts: how each part bends, on any grid, and what a press leaves.
#include "sim/embedding/embedding.h"
#include "sim/embedding/trilinear.h"
#include "sim/lattice/lattice.h"
#include "tests/verification/experiment.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

using namespace tests;

namespace {

/// The halves of a part with probes _root, _middle and _end.
struct Halves {
    Vec3 lower, upper;  // [m]

    Halves(const sim::Simulation& simulation, const std::string& part) {
        const Vec3 middle = probe(simulation, part + "_middle").position;
        lower = middle - probe(simulation, part + "_root").position;
        upper = probe(simulation, part + "_end").position - middle;
    }

    Vec3 normal() const { return lower.cross(upper); }

    /// The angle from the lower to the upper one about an axis.   [rad]
    double turn(const Vec3& axis) const {
        return std::atan2(axis.normalized().dot(normal()), lower.dot(upper));
    }
};

/// How much more a part curves than at rest, in the plane of its curve or, of a straight part, in any.   [rad/m]
double bend(const Halves& at_rest, const Halves& now) {
    const double straight = 0.1 * at_rest.lower.norm() * at_rest.upper.norm();
    const Vec3 axis = at_rest.normal().norm() > straight ? at_rest.normal() : now.normal();
    return std::abs(now.turn(axis) - at_rest.turn(axis))
           / ((at_rest.lower.norm() + at_rest.upper.norm()) / 2);
}

/// The dead load of a scene on its body, seen by probes on all corners that it pulls.
class Load {
  public:
    explicit Load(const sim::Scene& scene)
        : load_(std::get<sim::DeadLoad>(scene.forces.at(0))),
          first_probe_(scene.probes.size()) {
        const sim::Body& body = scene.bodies.at(0);
        const sim::Lattice lattice = sim::make_lattice(body);
        for (const int c : sim::select_corners(lattice, body, load_.select)) {
            pulled_.push_back({"pulled", body.name, lattice.corner_rest[c]});
            volume_.push_back(lattice.corner_volume[c]);
        }
    }

    /// Adds the probes to a scene with the same body.
    void watch(sim::Scene& scene) const {
        scene.probes.insert(scene.probes.end(), pulled_.begin(), pulled_.end());
    }

    /// What it has done so far: the load times the mean displacement, by volume.   [J]
    double work(const sim::Simulation& simulation) const {
        const std::vector<sim::ProbeRow> probes = simulation.probes();
        double volume = 0;
        Vec3 moved = Vec3::Zero();
        for (std::size_t k = 0; k < pulled_.size(); ++k) {
            const Vec3 at_rest = std::get<Vec3>(pulled_[k].at);
            volume += volume_[k];
            moved += volume_[k] * (probes[first_probe_ + k].position - at_rest);
        }
        return load_.total.dot(moved) / volume;
    }

  private:
    sim::DeadLoad load_;
    std::size_t first_probe_;
    std::vector<sim::Probe> pulled_;
    std::vector<double> volume_;  // (#pulled) [m³]
};

/// What a body shows that a load pulls from the first frame on.
struct Course {
    std::vector<Vec3> tip;                // a frame [m]
    std::map<std::string, double> bends;  // the greatest [rad/m]
    double smallest_J = 1;
    double most_work = 0;    // of the load [J]
    double most_gained = 0;  // energy beyond that work [J]
};

Course course_of(shots::Shot shot,
                 const Load& load,
                 int last_frame,
                 const std::vector<std::string>& parts,
                 const std::string& tip) {
    load.watch(shot.scene);
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    std::map<std::string, Halves> at_rest;
    for (const std::string& part : parts)
        at_rest.emplace(part, Halves(simulation, part));
    Course course;
    for (int frame = shot.frames.first; frame <= last_frame; ++frame) {
        simulation.advance_to(shot.time_of(frame));
        const sim::Stats stats = simulation.stats();
        const double work = load.work(simulation);
        course.most_work = std::max(course.most_work, work);
        course.most_gained =
            std::max(course.most_gained, stats.kinetic_energy + stats.elastic_energy - work);
        course.smallest_J = std::min(course.smallest_J, stats.smallest_J);
        course.tip.push_back(probe(simulation, tip).position);
        for (const std::string& part : parts)
            course.bends[part] =
                std::max(course.bends[part], bend(at_rest.at(part), Halves(simulation, part)));
    }
    return course;
}

/// Largest distance of two tips over the largest displacement of the first.
double difference(const Course& a, const Course& b) {
    double apart = 0, moved = 0;
    for (std::size_t k = 0; k < a.tip.size(); ++k) {
        apart = std::max(apart, (a.tip[k] - b.tip[k]).norm());
        moved = std::max(moved, (a.tip[k] - a.tip[0]).norm());
    }
    return apart / moved;
}

/// Backward Euler loses energy: what the load does not put in must come from rounding or the tolerance of Newton's
/// method.
void check_sound(const Course& course) {
    CHECK(course.most_gained < 1e-3 * course.most_work);
    CHECK(course.smallest_J > 0.3);
}

/// Where a point is in a domain with these corners now: Newton's method on the trilinear map from the middle.
Vec3 local_coordinates_of(const Vec3& x, const std::array<Vec3, 8>& corners) {
    Vec3 xi = Vec3::Constant(0.5);
    for (int step = 0; step < 20; ++step) {
        Vec3 at = Vec3::Zero();
        const std::array<double, 8> weights = sim::trilinear_weights(xi);
        for (int a = 0; a < 8; ++a)
            at += weights[a] * corners[a];
        xi += sim::trilinear_gradient(xi, 1, corners).partialPivLu().solve(x - at);
    }
    return xi;
}

/// A probe on each corner of a scene's body, so that domains can be seen.
class CornerProbes {
  public:
    explicit CornerProbes(sim::Scene& scene)
        : lattice(sim::make_lattice(scene.bodies.at(0))), first_(scene.probes.size()) {
        for (const Vec3& X : lattice.corner_rest)
            scene.probes.push_back({"corner", scene.bodies.at(0).name, X});
    }

    std::vector<Vec3> positions(const sim::Simulation& simulation) const {
        std::vector<Vec3> x;
        const std::vector<sim::ProbeRow> probes = simulation.probes();
        for (std::size_t k = first_; k < probes.size(); ++k)
            x.push_back(probes[k].position);
        return x;
    }

    const sim::Lattice lattice;

  private:
    std::size_t first_;
};

}  // namespace

TEST_CASE("flower [Z18 fig 11]: as many domains as in the paper") {
    const shots::Shot shot = load("flower", "enriched");
    const sim::Lattice lattice = sim::make_lattice(shot.scene.bodies[0]);
    CHECK(lattice.n_domains() == Approx(4904).epsilon(0.03));
    CHECK(count_boundary_domains(lattice) == Approx(118).epsilon(0.03));
}

TEST_CASE("flower [Z18 fig 11]: leaves bend most, the stem least, on any grid") {
    // The resolution of the grid halved twice. Of larger domains even the finest grid would hold nothing as thick as
    // the stem, so they are the shot's own; steps are long and few, to be cheap: leaves and petals have swung once, the
    // tip is on its way down.
    const int last_frame = 6;
    const auto shot = [](const std::string& grid_ratio, const std::string& enrich) {
        return load("flower",
                    "enriched",
                    {"solver.dt=21 ms",
                     "solver.grid_ratio=" + grid_ratio,
                     "solver.enrich=[" + enrich + "]"});
    };
    const std::string usual = "\"interface\", \"thin\"", of_paper = "\"interface\"";
    const Load load(shot("1", usual).scene);
    const auto course = [&](const char* grid_ratio, const std::string& enrich) {
        return course_of(
            shot(grid_ratio, enrich), load, last_frame, {"stem", "petal", "leaf"}, "tip");
    };
    const Course finest = course("1", usual), finer = course("2", usual),
                 coarse = course("4", usual);
    for (const Course* here : {&finest, &finer, &coarse}) {
        CAPTURE(difference(finest, *here));
        CHECK(difference(finest, *here) < 0.05);
        CHECK(here->bends.at("petal") > 1.3 * here->bends.at("stem"));
        CHECK(here->bends.at("leaf") > 1.3 * here->bends.at("petal"));
        check_sound(*here);
    }
    // Without thin domains, as in the paper, the grid would show.
    CHECK(difference(finest, course("4", of_paper)) > 0.05);
}

TEST_CASE("flower [Z18 fig 11]: explicit steps of the paper stay sound on the coarsest grid") {
    const shots::Shot shot =
        load("flower",
             "enriched",
             {"solver.steps=explicit", "solver.grid_ratio=4", "solver.damping=0"});
    const Course course = course_of(shot, Load(shot.scene), 36, {"stem"}, "tip");
    CHECK(course.most_gained < 1e-3 * course.most_work);
    CHECK(course.smallest_J > 0.3);
}

TEST_CASE("toy_ship [Z18 fig 9]: as many domains as in the paper") {
    const shots::Shot shot = load("toy_ship", "enriched");
    const sim::Lattice lattice = sim::make_lattice(shot.scene.bodies[0]);
    CHECK(lattice.n_domains() == Approx(9441).epsilon(0.03));
    CHECK(count_boundary_domains(lattice) == Approx(808).epsilon(0.03));
}

TEST_CASE("toy_ship [Z18 fig 9]: sails bend more than masts, the hull hardly") {
    const int last_frame = 27;  // the masts lean furthest at 24
    const shots::Shot shot =
        load("toy_ship", "enriched", {"body.ship.domain_size=40 mm", "solver.dt=20 ms"});
    Course course =
        course_of(shot, Load(shot.scene), last_frame, {"hull", "mast", "sail"}, "mast_end");
    CAPTURE(course.bends["hull"], course.bends["mast"], course.bends["sail"]);
    CHECK(course.bends["mast"] > 1.3 * course.bends["hull"]);
    CHECK(course.bends["sail"] > 1.3 * course.bends["mast"]);
    check_sound(course);
}

TEST_CASE("bunny_press [Z18 fig 4]: the surface stays with its domains, the tail recovers") {
    const int pressed = 18, last_frame = 48;  // the press rests from frame 13 to 19
    shots::Shot shot =
        load("bunny_press", "enriched", {"body.rabbit.domain_size=60 mm", "solver.dt=10 ms"});
    const CornerProbes probes(shot.scene);
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    const Vec3 at_rest = probe(simulation, "tail_end").position;
    const auto moved = [&] {
        return (probe(simulation, "tail_end").position - at_rest).norm();
    };
    double deepest = 0, furthest = 0;
    for (int frame = shot.frames.first; frame <= last_frame; ++frame) {
        simulation.advance_to(shot.time_of(frame));
        deepest = std::max(deepest, simulation.stats().collider_penetration);
        furthest = std::max(furthest, moved());
        CHECK(simulation.stats().smallest_J > 0.3);
        if (frame != pressed)
            continue;

        const sim::Lattice& lattice = probes.lattice;
        const std::vector<Vec3> corners = probes.positions(simulation);
        const std::vector<assets::CachedSurface> surfaces = simulation.surfaces();
        const std::vector<assets::SurfaceFrame> now = simulation.deformed_surfaces();
        int n_vertices = 0;
        double most_outside = 0;
        for (std::size_t k = 0; k < surfaces.size(); ++k) {
            if (surfaces[k].body != "rabbit")
                continue;
            std::vector<Vec3> rest;
            for (const Vec3f& X : surfaces[k].rest_positions)
                rest.push_back(X.cast<double>());
            const std::vector<sim::Binding> bindings = sim::bind_points(lattice, rest);
            for (std::size_t v = 0; v < rest.size(); ++v) {
                // A probe cannot tell corners at one place apart, where thigh and belly meet but do not grow together.
                if (lattice.part[bindings[v].domain] >= 0)
                    continue;
                const auto domain = sim::corners_of(lattice, bindings[v].domain, corners);
                // Positions are floats, of a metre: 1e-7 m in 60 mm.
                const Vec3 xi =
                    local_coordinates_of(now[k].positions[v].cast<double>(), domain);
                const Vec3 before = sim::local_coordinates(bindings[v].weights);
                REQUIRE(sim::trilinear_gradient(before, lattice.edge, domain).determinant()
                        > 0);
                // Beside where a sliver was two domains may be equally near: rounding tells which one carries.
                const double outside =
                    std::max(0.0, std::max(-before.minCoeff(), before.maxCoeff() - 1));
                REQUIRE((xi - before).norm() < (outside > 1e-9 ? 0.01 : 1e-4));
                ++n_vertices;
                most_outside = std::max(most_outside, outside);
            }
        }
        CHECK(n_vertices > 1000);
        CHECK(most_outside < 0.3);  // of a domain, where a sliver was
    }
    CHECK(deepest < 0.01);  // of a domain
    CHECK(furthest > 0.03);
    CHECK(moved() < 0.01 * furthest);
}
