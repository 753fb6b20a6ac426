#include "sim/lattice/region_report.h"

#include "assets/base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace sim {

namespace {

/// The region that hides a layer at some sample of the body, or -1 where the layer selects none.
int hidden_by(int region,
              const std::vector<FilledCube>& cubes,
              const CubeGrid& grid,
              const assets::Solid& solid,
              const RegionLayers& regions) {
    for (const FilledCube& cube : cubes)
        for (int q = 0; q < samples_per_cube; ++q) {
            const Vec3 X = sample_point(grid, cube.cell, q);
            if (regions.selects(region, X) && solid.signed_distance(X) <= 0)
                return regions.at(X);
        }
    return -1;
}

}  // namespace

RegionTally tally_regions(const std::vector<FilledCube>& cubes, std::size_t n_regions) {
    RegionTally tally{std::vector<double>(n_regions, 0),
                      std::vector<double>(n_regions, 0),
                      std::vector<char>(n_regions, false)};
    for (const FilledCube& cube : cubes) {
        std::pair<int, double> most{-1, 0};
        for (const auto& [region, count] : cube.samples) {
            tally.samples[region] += count;
            tally.largest[region] = std::max(tally.largest[region], count);
            if (count > most.second)
                most = {region, count};
        }
        tally.dominates[most.first] = true;
    }
    return tally;
}

void require_each_region(const Body& body,
                         const RegionTally& tally,
                         const std::vector<FilledCube>& cubes,
                         const CubeGrid& grid,
                         const assets::Solid& solid,
                         const RegionLayers& regions) {
    const auto none = std::find(tally.samples.begin(), tally.samples.end(), 0.0);
    if (none == tally.samples.end())
        return;
    const int r = static_cast<int>(none - tally.samples.begin());
    const Region& region = body.regions[r];
    const int cover = hidden_by(r, cubes, grid, solid, regions);
    if (cover >= 0)
        throw assets::Error(
            assets::ErrorKind::Input,
            fmt::format(
                "region \"{}\" is wholly hidden by region \"{}\", which comes later: put "
                "it after that one, or leave it out",
                region.name,
                body.regions[cover].name),
            region.select.key);
    throw assets::Error(
        assets::ErrorKind::Input,
        fmt::format(
            "region \"{}\" selects nothing of body \"{}\", which spans [{:g}, {:g}, {:g}] to "
            "[{:g}, {:g}, {:g}] m in domains of {:g} m",
            region.name,
            body.name,
            solid.min.x(),
            solid.min.y(),
            solid.min.z(),
            solid.max.x(),
            solid.max.y(),
            solid.max.z(),
            grid.edge),
        region.select.key);
}

void note_thin_regions(const Body& body,
                       const RegionTally& tally,
                       std::vector<std::string>& notes) {
    for (std::size_t r = 0; r < body.regions.size(); ++r) {
        if (tally.dominates[r])
            continue;
        const double share = tally.largest[r] / samples_per_cube;
        notes.push_back(
            fmt::format("region \"{}\" of body \"{}\" is thinner than a domain: about {:.2g} "
                        "m, where domain_size is {:g} m; "
                        "it only stiffens or softens the domains it shares",
                        body.regions[r].name,
                        body.name,
                        share * body.domain_size,
                        body.domain_size));
    }
}

}  // namespace sim
