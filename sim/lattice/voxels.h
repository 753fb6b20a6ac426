// The cubes of a regular grid that a body fills, and what fills them.
#pragma once

#include "sim/lattice/regions.h"

#include <array>
#include <cstdint>
#include <memory>
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

struct PartShape;  // part_shape.h

/// How many of a cube's samples are in the body, by region. A cube whose material is not connected in it has one for
/// each part.
struct FilledCube {
    FilledCube();
    FilledCube(FilledCube&&) noexcept;
    FilledCube& operator=(FilledCube&&) noexcept;
    ~FilledCube();

    std::array<int, 3> cell{0, 0, 0};
    double filled = 0;     // of samples_per_cube
    Vec3 moment{0, 0, 0};  // sum of their places in the cube, whose edge is samples_per_edge
    // (region, samples of it), regions ascending, none with 0.
    std::vector<std::pair<int, double>> samples;

    /// Samples in the body along each face, 2 axis + (0 low, 1 high): bit u + 8 v with u, v along the next two axes.
    /// Those of cubes sampled finely are in `shape`.
    std::array<std::uint64_t, 6> faces{};
    std::unique_ptr<const PartShape> shape;  // null where samples_per_edge were enough

    bool is_whole() const { return !shape && filled == samples_per_cube; }

    /// Adds samples of a region, keeping regions ascending.
    void add(int region, double count);
};

/// Places the grid over a solid's bounds: at them along axes where s divides them (within 1e-6 s), centred otherwise.
/// Throws Error(Input) where the grid would have too many cubes for any machine.
CubeGrid place_grid(const assets::Solid& solid, const Body& body);

/// Cubes with any sample inside, sorted by z, y, x, and by their parts. Cubes at parts of the body thinner than s, and
/// those that hold several parts, are sampled finely, with cells partly filled.
std::vector<FilledCube> fill_cubes(const CubeGrid& grid,
                                   const assets::Solid& solid,
                                   const RegionLayers& regions);

/// Midpoint sample q of a cube, 0 <= q < samples_per_cube.   [m]
Vec3 sample_point(const CubeGrid& grid, const std::array<int, 3>& cell, int q);

}  // namespace sim
