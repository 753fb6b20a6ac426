// Experiments of [Z18] on bodies of several parts: how each part bends, on grids of any fineness, and what a press leaves.
#include "sim/lattice/lattice.h"
#include "tests/verification/experiment.h"

#include <catch2/catch.hpp>

#include <algorithm>
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

/// Backward Euler loses energy: what the load does not put in must come from rounding or the tolerance of Newton's method.
void check_sound(const Course& course) {
    CHECK(course.most_gained < 1e-3 * course.most_work);
    CHECK(course.smallest_J > 0.3);
}

}  // namespace

TEST_CASE("flower [Z18 fig 11]: as many domains as in the paper") {
    const shots::Shot shot = load("flower", "enriched");
    const sim::Lattice lattice = sim::make_lattice(shot.scene.bodies[0]);
    CHECK(lattice.n_domains() == Approx(4904).epsilon(0.03));
    CHECK(count_boundary_domains(lattice) == Approx(118).epsilon(0.03));
}

TEST_CASE("flower [Z18 fig 11]: leaves bend most, the stem least, on grids of any fineness") {
    // The resolution of the grid halved twice. Of larger domains even the finest grid would hold nothing as thick as the
    // stem, so they are the shot's own; steps are long and few, to be cheap: leaves and petals have swung once, the tip is
    // on its way down.
    const int last_frame = 6;
    const auto shot = [](const std::string& grid_ratio) {
        return load("flower",
                    "enriched",
                    {"body.flower.domain_size=9 mm",
                     "solver.dt=21 ms",
                     "solver.grid_ratio=" + grid_ratio});
    };
    const Load load(shot("1").scene);
    std::vector<Course> courses;
    for (const char* grid_ratio : {"1", "4"})
        courses.push_back(
            course_of(shot(grid_ratio), load, last_frame, {"stem", "petal", "leaf"}, "tip"));
    for (Course& course : courses) {
        CAPTURE(course.bends["stem"], course.bends["petal"], course.bends["leaf"]);
        CHECK(difference(courses[0], course) < 0.05);
        CHECK(course.bends["petal"] > 1.3 * course.bends["stem"]);
        CHECK(course.bends["leaf"] > 1.3 * course.bends["petal"]);
        check_sound(course);
    }
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
