// Experiments of [Z18] in which several bodies fall on each other, from the shot files that film them.
#include "tests/support/soft_block.h"
#include "tests/verification/experiment.h"

#include <catch2/catch.hpp>

#include <algorithm>
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

    // A domain for each of the five layers.
    std::vector<std::string> overrides;
    for (const std::string& cube : cubes)
        overrides.push_back("body." + cube + ".domain_size=190 mm");
    const shots::Shot shot = load("four_cubes", "enriched", overrides);
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    std::map<std::string, Course> courses;
    double before = energy(simulation.stats()), deepest = 0;
    for (int k = 0; k <= 150; ++k) {
        simulation.advance_to(sample * k);
        const sim::Stats stats = simulation.stats();
        CHECK(energy(stats) <= before * (1 + 1e-6));  // what Newton leaves
        before = energy(stats);
        deepest = std::max({deepest, stats.penetration, stats.collider_penetration});
        for (const std::string& cube : cubes)
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
