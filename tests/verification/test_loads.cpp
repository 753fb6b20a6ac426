// Experiments of [Z18] in which bodies break, fall and hit the ground, from the shot files that film them.
#include "tests/verification/experiment.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

using namespace tests;

namespace {

const double never = 9;  // beyond the fivefold length to which the bars are pulled

/// The bars of stretch_bars and what holds them, with a probe in the middle of each of their layers.
shots::Shot bars(const std::vector<std::string>& names, std::vector<std::string> overrides) {
    overrides.push_back(
        "solver.dt=4 ms");  // the gaps open in the same frames by the shot's 2 ms
    shots::Shot shot = load("stretch_bars", "domains", overrides);
    const auto is_left_out = [&](const std::string& bar) {
        return std::find(names.begin(), names.end(), bar) == names.end();
    };
    std::erase_if(shot.scene.bodies, [&](const sim::Body& it) { return is_left_out(it.name); });
    std::erase_if(shot.scene.pins, [&](const sim::Pin& it) { return is_left_out(it.body); });
    const std::map<std::string, double> axes = {
        {"linear", -0.6}, {"cubic", 0}, {"domains", 0.6}};
    for (const std::string& bar : names)
        for (int k = 0; k < 16; ++k)
            shot.scene.probes.push_back({bar, bar, Vec3(0.025 + 0.05 * k, axes.at(bar), 0)});
    return shot;
}

/// Per bar, by how much the largest distance of neighbouring layers exceeds the mean one.   [m]
std::map<std::string, double> gaps(const sim::Simulation& simulation) {
    std::map<std::string, std::vector<Vec3>> layers;
    for (const sim::ProbeRow& row : simulation.probes())
        layers[row.name].push_back(row.position);
    std::map<std::string, double> gaps;
    for (const auto& [bar, middles] : layers) {
        double largest = 0, sum = 0;
        for (std::size_t k = 1; k < middles.size(); ++k) {
            const double distance = (middles[k] - middles[k - 1]).norm();
            largest = std::max(largest, distance);
            sum += distance;
        }
        gaps[bar] = largest - sum / static_cast<double>(middles.size() - 1);
    }
    return gaps;
}

/// Per bar, the stretch at which such a gap exceeds a cell of the background grid, by `last` at most.
std::map<std::string, double> breaks(const shots::Shot& shot, int last) {
    const double cell = 0.1, length = 0.8, speed = 1.0667;
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    std::map<std::string, double> breaks;
    for (const sim::Body& body : shot.scene.bodies)
        breaks[body.name] = never;
    for (int frame = shot.frames.first; frame <= last; ++frame) {
        simulation.advance_to(shot.time_of(frame));
        const double stretch = 1 + speed * simulation.time() / length;
        for (const auto& [bar, gap] : gaps(simulation))
            if (gap > cell)
                breaks[bar] = std::min(breaks[bar], stretch);
    }
    return breaks;
}

}  // namespace

TEST_CASE(
    "stretch_bars [Z18 fig 2]: linear points tear first, cubic ones later, domains never") {
    auto points = breaks(bars({"linear", "cubic"}, {}), 33);
    WARN("gaps of a cell open at a stretch of " << points["linear"] << " (linear), "
                                                << points["cubic"] << " (cubic)");
    // Points are half a cell apart at first, so beyond a stretch of 2 neighbours need not share a cell.
    CHECK(points["linear"] > 1.5);
    CHECK(points["linear"] < 2.1);
    CHECK(points["cubic"] > points["linear"] + 0.2);
    CHECK(points["cubic"] < never);

    // One material only has no boundary domains; squeezed domains are enriched by the other criterion.
    const shots::Shot averaged = bars({"domains"}, {});
    const shots::Shot enriched =
        bars({"domains"}, {"body.domains.method=enriched", "solver.enrich=[\"strain\"]"});
    CHECK(averaged.time_of(averaged.frames.last) * 1.0667 / 0.8
          > 3.99);  // pulled to five times
    CHECK(breaks(averaged, averaged.frames.last)["domains"] == never);
    CHECK(breaks(enriched, enriched.frames.last)["domains"] == never);
}
