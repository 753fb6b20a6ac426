// Experiments of [Z18] in which several bodies fall on each other, from the shot files that film them.
#include "tests/support/soft_block.h"
#include "tests/verification/experiment.h"

#include <Eigen/SVD>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

using namespace tests;

namespace {

const std::vector<std::string> cubes = {"red", "blue", "green", "violet"};  // from below

constexpr double sample = 0.02;  // between the times at which the cubes are looked at [s]

/// Heights of a centre at each sample.   [m]
using Course = std::vector<double>;

/// The first time at which it gains speed upwards: it has hit what is below.   [s]
double arrival(const Course& y) {
    for (std::size_t k = 1; k + 1 < y.size(); ++k)
        if (y[k + 1] - 2 * y[k] + y[k - 1] > 0)
            return sample * static_cast<double>(k);
    return 9;
}

}  // namespace

TEST_CASE("four_cubes [Z18 fig 15]: they arrive by height, stay apart, and come to rest") {
    const shots::Shot filmed = load("four_cubes", "enriched");
    const sim::Simulation fine(filmed.scene, 1 / filmed.fps);
    for (int b = 0; b < 4; ++b) {
        CHECK(fine.lattice(b).n_domains() == 27436 / 4);
        CHECK(count_boundary_domains(fine.lattice(b)) == 11552 / 4);
    }

    // A domain for each of the five layers: by `enriched` all are boundary domains, by `domains` none is.
    const std::string method = GENERATE("enriched", "domains");
    CAPTURE(method);
    std::vector<std::string> overrides;
    for (const std::string& cube : cubes)
        overrides.push_back("body." + cube + ".domain_size=190 mm");
    const shots::Shot shot = load("four_cubes", method, overrides);
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    std::map<std::string, Course> courses;
    double before = energy(simulation.stats()), deepest = 0;
    constexpr int steps = 5;  // of 4 ms in a sample, each looked at
    for (int k = 0; k <= 150 * steps; ++k) {
        simulation.advance_to(sample * k / steps);
        const sim::Stats stats = simulation.stats();
        CHECK(energy(stats) <= before * (1 + 1e-6));  // what Newton leaves
        before = energy(stats);
        deepest = std::max({deepest, stats.penetration, stats.collider_penetration});
        for (const std::string& cube : cubes)
            if (k % steps == 0)
                courses[cube].push_back(probe(simulation, cube).position.y());
    }
    const sim::Stats rest = simulation.stats();
    CAPTURE(deepest, rest.penetration, rest.kinetic_energy);
    CHECK(deepest < 0.02);
    CHECK(rest.penetration < 0.01);
    CHECK(rest.collider_penetration < 0.01);

    // Drops of 0.1, 0.2, 0.45 and 0.7 m, relative to the ground, take 0.14, 0.20, 0.30 and 0.38 s.
    for (std::size_t k = 1; k < cubes.size(); ++k) {
        CAPTURE(cubes[k], arrival(courses[cubes[k - 1]]), arrival(courses[cubes[k]]));
        CHECK(arrival(courses[cubes[k - 1]]) < arrival(courses[cubes[k]]));
    }

    // They move by less than a centimetre a second, in three storeys. A cube carries at most two others: 2.5 rho g L / E
    // of the soft layers shorten it by 5%, of which the centre takes half.
    const double side = 0.95;
    const std::map<std::string, double> storeys = {
        {"red", 0.5}, {"blue", 0.5}, {"green", 1.5}, {"violet", 2.5}};
    for (const std::string& cube : cubes) {
        const Course& y = courses[cube];
        CAPTURE(cube, y.back());
        CHECK(std::abs(y.back() - y[y.size() - 6]) < 0.01 * 5 * sample);
        CHECK(y.back() < storeys.at(cube) * side);
        CHECK(y.back() > storeys.at(cube) * side * 0.95);
    }
}

namespace {

/// snow_bunny with domains and points of twice the size, by as long steps as explicit ones may be. Without thin domains: of
/// that size all would be.
shots::Shot coarse_bunny() {
    return load("snow_bunny",
                "enriched",
                {"solver.dt=1 ms",
                 "solver.enrich=[\"interface\"]",
                 "body.bunny.domain_size=80 mm",
                 "body.snow.domain_size=80 mm"});
}

/// How far x is from a turned and shifted X: root of the mean square after the best fit (Kabsch).   [m]
double distortion(const std::vector<Vec3f>& X, const std::vector<Vec3f>& x) {
    Vec3 centre_X = Vec3::Zero(), centre_x = Vec3::Zero();
    const double n = static_cast<double>(X.size());
    for (std::size_t v = 0; v < X.size(); ++v) {
        centre_X += X[v].cast<double>() / n;
        centre_x += x[v].cast<double>() / n;
    }
    Mat3 moment = Mat3::Zero();
    for (std::size_t v = 0; v < X.size(); ++v)
        moment +=
            (x[v].cast<double>() - centre_x) * (X[v].cast<double>() - centre_X).transpose();
    const Eigen::JacobiSVD<Mat3> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 mirror = Mat3::Identity();
    mirror(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    const Mat3 R = svd.matrixU() * mirror * svd.matrixV().transpose();
    double sum = 0;
    for (std::size_t v = 0; v < X.size(); ++v)
        sum += (x[v].cast<double>() - centre_x - R * (X[v].cast<double>() - centre_X))
                   .squaredNorm();
    return std::sqrt(sum / n);
}

/// Height of the highest snow under the hind feet, where the bunny comes down; not finite if any snow is not.   [m]
double height_under_feet(const sim::Simulation& simulation) {
    const sim::PointCloud snow = simulation.point_clouds()[0];
    double height = 0;
    for (const Vec3& x : snow.positions) {
        if (!x.allFinite())
            return std::numeric_limits<double>::quiet_NaN();
        if (std::abs(x.x() + 0.1) < 0.15 && std::abs(std::abs(x.z()) - 0.24) < 0.05)
            height = std::max(height, x.y());
    }
    return height;
}

}  // namespace

TEST_CASE("snow_bunny [Z18 fig 14]: as many domains and points as its file says") {
    const shots::Shot filmed = load("snow_bunny", "enriched");
    const sim::Simulation simulation(filmed.scene, 1 / filmed.fps);
    const int n_domains = simulation.lattice(0).n_domains(),
              n_points = static_cast<int>(simulation.point_clouds()[0].positions.size());
    CHECK(n_domains == 5394);
    CHECK(n_points == 22380);
    CHECK(n_domains + n_points == Approx(27779).epsilon(0.01));  // the paper's
}

TEST_CASE("snow_bunny [Z18 fig 14]: snow keeps the crater, the bunny recovers its shape") {
    const shots::Shot shot = coarse_bunny();
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    const std::vector<Vec3f> at_rest = simulation.deformed_surfaces()[0].positions;
    const double top = height_under_feet(simulation);
    double before = energy(simulation.stats()), worst = 0, least = 0;
    for (int frame = 2; frame <= 24; ++frame) {
        simulation.advance_to(shot.time_of(frame));
        const double now = energy(simulation.stats());
        CHECK(now < before);
        before = now;
        const double distorted =
            distortion(at_rest, simulation.deformed_surfaces()[0].positions);
        REQUIRE(std::isfinite(distorted));
        REQUIRE(std::isfinite(height_under_feet(simulation)));
        least = distorted > worst ? distorted : std::min(least, distorted);
        worst = std::max(worst, distorted);
    }
    // The elastic part of what snow gives way by is its compression limit of its height at most; the rest stays.
    const double crater = top - height_under_feet(simulation);
    CAPTURE(crater, worst, least);
    CHECK(crater > 2 * 0.025 * 0.48);
    CHECK(least < worst / 3);  // its ears swing on, through the shape that they had
}

TEST_CASE("snow_bunny [Z18 fig 14]: momentum changes by the weight alone") {
    shots::Shot shot = coarse_bunny();
    shot.scene.colliders.clear();
    shot.scene.solver.damping = 0;
    shot.scene.bodies[0].velocity = {
        0.5, -6, 0};  // 0.3 m above the snow: it is there after 0.05 s
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    const sim::Stats start = simulation.stats();
    const double reached = 0.12;
    simulation.advance_to(reached);
    const sim::Stats end = simulation.stats();
    const Vec3 impulse = start.total_mass * reached * Vec3(0, -9.81, 0);
    // Rounding of 1e-16 in each of some 250 steps of 4000 points and corners.
    CHECK((end.linear_momentum - start.linear_momentum - impulse).norm()
          < 1e-11 * start.linear_momentum.norm());
    // They have met: the snow is lower than by its fall alone.
    CHECK(probe(simulation, "snow").position.y() < 0.24 - 9.81 * reached * reached / 2);
}
