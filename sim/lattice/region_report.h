// What the regions of a body got, and complaints about those that got nothing or little.
#pragma once

#include "sim/lattice/voxels.h"

#include <string>
#include <vector>

namespace sim {

struct RegionTally {
    std::vector<double> samples;  // (#regions) in all cubes
    std::vector<double> largest;  // (#regions) most samples in one cube
    std::vector<char> dominates;  // (#regions) whether it has the largest share of any cube
};

RegionTally tally_regions(const std::vector<FilledCube>& cubes, std::size_t n_regions);

/// Throws Error(Input) with the key of the first region without samples: it selects nothing of the body, or later
/// layers hide it.
void require_each_region(const Body& body,
                         const RegionTally& tally,
                         const std::vector<FilledCube>& cubes,
                         const CubeGrid& grid,
                         const assets::Solid& solid,
                         const RegionLayers& regions);

/// Adds a note for each region that is thinner than a domain.
void note_thin_regions(const Body& body,
                       const RegionTally& tally,
                       std::vector<std::string>& notes);

}  // namespace sim
