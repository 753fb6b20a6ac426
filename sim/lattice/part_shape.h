// Cubes sampled finely: their connected parts, and where those lie.
#pragma once

#include "sim/lattice/lattice.h"
#include "sim/lattice/voxels.h"

#include <array>
#include <cstdint>
#include <vector>

namespace sim {

/// Cells per edge of a cube that is sampled finely.
inline constexpr int fine_per_edge = 32;

/// Fine cells along a face that hold material: bit u of row v, u and v along the two axes after the face's.
using FaceMask = std::array<std::uint32_t, fine_per_edge>;

/// Where one part lies in its cube. A cell holds material where the surface passes through it: parts thinner than a cell
/// are not broken into pieces.
struct PartShape {
    std::array<FaceMask, 6> faces{};  // 2 axis + (0 low, 1 high)
    PartBlocks blocks;
};

/// Fills a cube from fine cells, each by the fraction of it under the surface as its distance tells, and divides it into
/// parts that are connected in it face to face. Parts smaller than 1e-4 of the cube are left out.
std::vector<FilledCube> fill_finely(const CubeGrid& grid,
                                    const assets::Solid& solid,
                                    const RegionLayers& regions,
                                    const std::array<int, 3>& cell);

/// Fine cells with material along one face of a cube that was not sampled finely, and its blocks.
FaceMask face_mask(const CubeGrid& grid,
                   const assets::Solid& solid,
                   const std::array<int, 3>& cell,
                   int face);
PartBlocks part_blocks(const CubeGrid& grid,
                       const assets::Solid& solid,
                       const std::array<int, 3>& cell);

}  // namespace sim
