// Experiments of [Z18], from the shot files that film them: what a body of several stiffnesses must show.
#include "tests/verification/experiment.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

using namespace tests;

namespace {

/// Of the pressed shot, whose states hardly depend on the step: they follow their pins.
const std::vector<std::string> coarse_steps = {"solver.dt=4 ms"};

/// Height of the bar's tip where it hangs lowest in the first 12 frames, which hold its first swing.   [m]
double lowest_tip(const std::string& method) {
    const shots::Shot shot = load("bar", method);
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    double lowest = 0;
    for (int frame = shot.frames.first; frame <= 12; ++frame) {
        simulation.advance_to(shot.time_of(frame));
        lowest = std::min(lowest, probe(simulation, "tip").position.z());
    }
    return lowest;
}

/// Share of the pressed cube's compression that its two soft layers take, measured on its axis.
double soft_share(const sim::Simulation& simulation) {
    const auto height = [&](const char* name) { return probe(simulation, name).position.y(); };
    const double lower = 0.25 - (height("y450") - height("y200"));
    const double upper = 0.25 - (height("y900") - height("y650"));
    return (lower + upper) / (1.1 - height("y1100"));
}

/// Strains of the rows of the shot `rows` in the middle, from below, when the pull has ended.
std::array<double, 9> row_strains(const std::string& method) {
    constexpr double height = 0.1;  // of a row [m]
    shots::Shot shot = load("rows", method);
    shot.scene.probes.clear();
    for (int k = 0; k <= 9; ++k)
        shot.scene.probes.push_back({"", "rows", Vec3(0, height * (k - 4.5), 0)});
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    simulation.advance_to(shot.time_of(25));
    const std::vector<sim::ProbeRow> at = simulation.probes();
    std::array<double, 9> strains{};
    for (int k = 0; k < 9; ++k)
        strains[k] = (at[k + 1].position.y() - at[k].position.y()) / height - 1;
    return strains;
}

}  // namespace

TEST_CASE("bar [Z18 fig 13]: enriched hangs as low as fem, domains are stiffer") {
    const double fem = lowest_tip("fem");
    const double enriched = lowest_tip("enriched");
    const double domains = lowest_tip("domains");
    CAPTURE(fem, enriched, domains);
    CHECK(fem < -0.05);  // it bends by more than a tenth of its length
    CHECK(enriched == Approx(fem).epsilon(0.02));
    CHECK(domains > enriched);
    CHECK(domains > fem);
}

TEST_CASE("two_balls [Z18 fig 10]: softer parts stretch more, by enriched as by fem") {
    const int frame = 72;  // half as high again
    const auto by = [&](const char* method, const char* dt) {
        return stretches(load("two_balls", method, {std::string("solver.dt=") + dt}), frame);
    };
    auto fem = by("fem", "20 ms"), enriched = by("enriched", "20 ms"),
         domains = by("domains", "20 ms"), mpm = by("mpm", "5 ms");
    // fem, four times finer: supple sim shots/two_balls.toml --set solver.method=fem
    // --set body.box.domain_size=0.0625 --set solver.dt="41.666666666 ms"
    std::map<std::string, double> fine{{"left", 1.9265}, {"rubber", 1.5123}, {"right", 1.1126}};
    const auto strain = [](std::map<std::string, double>& of, const char* name) {
        return of[name] - 1;
    };
    for (const char* name : {"left", "rubber", "right"}) {
        CAPTURE(name, fem[name], enriched[name], domains[name], mpm[name]);
        CHECK(enriched[name] == Approx(fine[name]).epsilon(0.05));
        CHECK(strain(enriched, name) == Approx(strain(fem, name)).epsilon(0.05));
    }
    for (auto* of : {&fem, &enriched}) {
        CHECK((*of)["left"] > (*of)["rubber"]);
        CHECK((*of)["rubber"] > (*of)["right"]);
        CHECK((*of)["right"] > 1);
    }
    // Nodes average what is around them: the hard ball gives way with the rubber, the soft one is held by it. The pins hold
    // points below the top, so the rubber of points is pulled less: strains are compared with its own.
    CHECK(strain(domains, "right") > 1.05 * strain(fem, "right"));
    CHECK(strain(domains, "left") < strain(fem, "left"));
    CHECK(strain(mpm, "left") / strain(mpm, "rubber")
          < 0.95 * strain(fem, "left") / strain(fem, "rubber"));
}

TEST_CASE("rows [Z18 fig 3]: rows inside one cell keep their own strain") {
    const int frame = 25;  // the pull ends
    auto fem = stretches(load("rows", "fem"), frame);
    auto enriched = stretches(load("rows", "enriched"), frame);
    const auto strain_ratio = [](std::map<std::string, double>& of) {
        return (of["soft"] - 1) / (of["hard"] - 1);
    };
    CAPTURE(strain_ratio(fem), strain_ratio(enriched));
    for (const char* row : {"soft", "hard"})
        CHECK(enriched[row] - 1 == Approx(fem[row] - 1).epsilon(0.05));
    CHECK(strain_ratio(fem) > 5);
    CHECK(strain_ratio(enriched) > 5);
}

TEST_CASE("rows [Z18 fig 3]: by domains, rows inside one cell all strain alike") {
    const std::array<double, 9> strains = row_strains("domains");
    for (int k = 2; k <= 7; ++k) {
        CAPTURE(k);
        CHECK(strains[k] == Approx(strains[1]).epsilon(0.01));
    }
    // The lowest and the highest row, hard ones, are in series with the cell: the pins move their outer corners, the nodes
    // the inner. Together seven rows of 0.1 and 1 MPa at one strain have (4 x 0.1 + 3 x 1) / 7 = 0.49 of the modulus of a
    // hard row; at such strains stiffening changes that by little.
    for (const int k : {0, 8}) {
        CAPTURE(k);
        CHECK(strains[k] < 0.55 * strains[1]);
        CHECK(strains[k] > 0.35 * strains[1]);
    }
}

TEST_CASE("layered_cube [Z18 fig 8]: the soft layers take their share of series springs") {
    const shots::Shot shot = load("layered_cube", "enriched", coarse_steps);
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    CHECK(count_boundary_domains(simulation.lattice(0)) == 8 * 22 * 22);
    simulation.advance_to(shot.time_of(25));  // pressed by a quarter of its height

    // Layers in series carry one stress p, so a layer of height H shortens by p H / M, M = E (1-nu) / ((1+nu)(1-2nu))
    // where its sides are held (oedometric), M = E where they are free. nu is one for all: its factor cancels.
    const double soft = (0.25 + 0.25) / 100e3, hard = (0.2 + 0.2 + 0.2) / 10e6;  // H / E [m/Pa]
    const double expected = soft / (soft + hard);                                // 0.988
    CHECK(1.1 - probe(simulation, "y1100").position.y() == Approx(0.275).epsilon(1e-6));
    const double share = soft_share(simulation);
    CHECK(share == Approx(expected).epsilon(0.01));

    // Let go, it swings, but is neither crushed nor gets into itself.
    for (int frame = 26; frame <= shot.frames.last; ++frame) {
        simulation.advance_to(shot.time_of(frame));
        CAPTURE(frame);
        CHECK(simulation.stats().smallest_J > 0.2);
        CHECK(simulation.stats().penetration < 0.02);
    }

    // Springs know nothing of what happens at interfaces: averaging there moves the share by a twentieth of a percent
    // only, towards the hard layers.
    const shots::Shot averaging = load("layered_cube", "domains", coarse_steps);
    sim::Simulation averaged(averaging.scene, 1 / averaging.fps);
    averaged.advance_to(averaging.time_of(25));
    CHECK(soft_share(averaged) < share);
}
