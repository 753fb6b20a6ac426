// The cubes of a regular grid that a body fills, and what fills them.
#pragma once

#include "sim/lattice/regions.h"

#include <array>
#include <utility>
#include <vector>

namespace sim {

/// Cubes of edge s in a box of n[0] × n[1] × n[2].
struct CubeGrid {
    double edge = 0;                // s [m]
    Vec3 origin{0, 0, 0};           // lowest corner of cube (0,0,0) [m]
    std::array<int, 3> n{0, 0, 0};  // cubes along each axis

    Vec3 point(double i, double j, double k) const { return origin + edge * Vec3(i, j, k); }
};

/// Samples per edge of a cut cube, and in the whole cube.
inline constexpr int samples_per_edge = 8;
inline constexpr int samples_per_cube = samples_per_edge * samples_per_edge * samples_per_edge;

/// How many of a cube's samples are in the body, by region.
struct FilledCube {
    std::array<int, 3> cell{0, 0, 0};
    int filled = 0;        // of samples_per_cube
    Vec3 moment{0, 0, 0};  // sum of their places in the cube, whose edge is samples_per_edge
    std::vector<std::pair<int, int>>
        samples;  // (region, samples of it), regions ascending, none with 0
};

/// Places the grid over a solid's bounds: at them along axes where s divides them (within 1e-6 s), centred otherwise.
/// Throws Error(Input) where the grid would have too many cubes for any machine.
CubeGrid place_grid(const assets::Solid& solid, const Body& body);

/// Cubes with any sample inside, sorted by z, y, x.
std::vector<FilledCube> fill_cubes(const CubeGrid& grid,
                                   const assets::Solid& solid,
                                   const RegionLayers& regions);

/// Midpoint sample q of a cube, 0 <= q < samples_per_cube.   [m]
Vec3 sample_point(const CubeGrid& grid, const std::array<int, 3>& cell, int q);

}  // namespace sim
