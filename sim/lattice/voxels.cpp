#include "sim/lattice/voxels.h"

#include "assets/base/error.h"
#include "sim/lattice/block_walk.h"
#include "sim/lattice/part_shape.h"
#include "sim/lattice/thickness.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <tuple>
#include <utility>

namespace sim {

namespace {

// Above this a run would neither fit in memory nor end: a slip of the unit in domain_size, most likely.
constexpr double most_cubes = 3e8;

// A part of the body where no ball of this radius fits is thinner than a domain. Slightly less than half an edge, so that
// bodies one domain thick are not.
constexpr double thin_depth = 0.49;  // [domain edges]

/// A cube's samples by planes across z: bit x + 8 y of plane z.
using Planes = std::array<std::uint64_t, samples_per_edge>;

/// Whether all samples are connected face to face: the lowest, grown through them, reaches all.
bool is_one_piece(const Planes& planes) {
    constexpr std::uint64_t lowest_x = 0x0101010101010101;
    Planes grown{};
    for (int z = 0; z < samples_per_edge; ++z)
        if (planes[z] != 0) {
            grown[z] = planes[z] & (~planes[z] + 1);
            break;
        }
    for (bool grows = true; grows;) {
        grows = false;
        for (int z = 0; z < samples_per_edge; ++z) {
            const std::uint64_t g = grown[z];
            std::uint64_t more =
                g | (g << 1 & ~lowest_x) | (g & ~lowest_x) >> 1 | g << 8 | g >> 8;
            more |= (z > 0 ? grown[z - 1] : 0) | (z + 1 < samples_per_edge ? grown[z + 1] : 0);
            more &= planes[z];
            grows |= more != g;
            grown[z] = more;
        }
    }
    return grown == planes;
}

std::array<std::uint64_t, 6> faces_of(const Planes& planes) {
    constexpr int m = samples_per_edge;
    std::array<std::uint64_t, 6> faces{};
    faces[4] = planes[0];
    faces[5] = planes[m - 1];
    for (int z = 0; z < m; ++z)
        for (int i = 0; i < m; ++i)
            for (const int side : {0, 1}) {
                const int end = side * (m - 1);
                const std::uint64_t at_x = planes[z] >> (end + m * i) & 1,
                                    at_y = planes[z] >> (i + m * end) & 1;
                faces[side] |= at_x << (i + m * z);      // u, v = y, z
                faces[2 + side] |= at_y << (z + m * i);  // u, v = z, x
            }
    return faces;
}

/// What the regular samples of a cube tell of it.
struct SampledCube {
    FilledCube cube;
    bool is_thin = false, is_one_piece = true;
};

SampledCube sample_cube(const CubeGrid& grid,
                        const assets::Solid& solid,
                        const RegionLayers& regions,
                        const std::array<int, 3>& cell) {
    SampledCube sampled;
    sampled.cube.cell = cell;
    Planes planes{};
    Thickness thickness(solid, thin_depth * grid.edge);
    // The surface passes through a sample's cell only if its middle is half a diagonal away at most.
    const double half_diagonal = std::sqrt(3.0) / 2 * grid.edge / samples_per_edge;
    const auto take = [&](const Block& block, int region, double distance) {
        if (region >= 0) {
            const double count = block.size * block.size * block.size;
            sampled.cube.add(region, count);
            sampled.cube.moment += count
                                   * (Vec3(block.low[0], block.low[1], block.low[2])
                                      + Vec3::Constant(block.size / 2.0));
            for_samples(block, [&](int x, int y, int z) {
                planes[z] |= std::uint64_t{1} << (x + samples_per_edge * y);
            });
        }
        if (block.size == 1 && !sampled.is_thin && std::abs(distance) <= half_diagonal) {
            const auto& [x, y, z] = block.low;
            const Vec3 X =
                sample_point(grid, cell, x + samples_per_edge * (y + samples_per_edge * z));
            sampled.is_thin = thickness.is_thin_at(X, distance);
        }
    };
    BlockWalk(grid, solid, regions, {samples_per_edge, half_diagonal, 0, 0}, take).walk(cell);
    sampled.cube.faces = faces_of(planes);
    sampled.is_one_piece = is_one_piece(planes);
    return sampled;
}

using Cell = std::array<int, 3>;

/// Order of cubes: by z, then y, then x.
bool comes_before(const Cell& a, const Cell& b) {
    return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
}

/// The cells to sample finely: thin ones, and what of their neighbours' faces is not wholly inside, so that a thin part
/// is seen on both sides of a face.
std::vector<Cell> with_neighbours(const std::vector<Cell>& thin,
                                  const std::vector<FilledCube>& cubes,
                                  const CubeGrid& grid) {
    std::vector<Cell> cells = thin;
    for (const Cell& cell : thin)
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) {
                Cell neighbour = cell;
                neighbour[axis] += side;
                if (neighbour[axis] < 0 || neighbour[axis] >= grid.n[axis])
                    continue;
                const auto at =
                    std::lower_bound(cubes.begin(),
                                     cubes.end(),
                                     neighbour,
                                     [](const FilledCube& cube, const Cell& wanted) {
                                         return comes_before(cube.cell, wanted);
                                     });
                if (at == cubes.end() || at->cell != neighbour || !at->is_whole())
                    cells.push_back(neighbour);
            }
    std::sort(cells.begin(), cells.end(), comes_before);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
}

/// Puts finely sampled cubes in the place of others; both sorted.
std::vector<FilledCube> replaced(std::vector<FilledCube> cubes,
                                 const std::vector<Cell>& cells,
                                 std::vector<std::vector<FilledCube>> parts) {
    std::vector<FilledCube> result;
    auto cube = cubes.begin();
    for (std::size_t k = 0; k < cells.size(); ++k) {
        for (; cube != cubes.end() && comes_before(cube->cell, cells[k]); ++cube)
            result.push_back(std::move(*cube));
        while (cube != cubes.end() && cube->cell == cells[k])
            ++cube;
        std::move(parts[k].begin(), parts[k].end(), std::back_inserter(result));
    }
    std::move(cube, cubes.end(), std::back_inserter(result));
    return result;
}

}  // namespace

FilledCube::FilledCube() = default;
FilledCube::FilledCube(FilledCube&&) noexcept = default;
FilledCube& FilledCube::operator=(FilledCube&&) noexcept = default;
FilledCube::~FilledCube() = default;

void FilledCube::add(int region, double count) {
    auto at = std::lower_bound(samples.begin(), samples.end(), std::pair(region, 0.0));
    if (at == samples.end() || at->first != region)
        at = samples.insert(at, {region, 0});
    at->second += count;
    filled += count;
}

CubeGrid place_grid(const assets::Solid& solid, const Body& body) {
    const double s = body.domain_size;
    CubeGrid grid{s, Vec3::Zero(), {}};
    double total = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double extent = (solid.max[axis] - solid.min[axis]) / s;
        const double n = std::max(1.0, std::ceil(extent - selection_tolerance));
        total *= n;
        if (!(total <= most_cubes))
            throw assets::Error(assets::ErrorKind::Input,
                                fmt::format("domain_size {:g} m would cut body \"{}\" of {:g} "
                                            "x {:g} x {:g} m into more than {:g} "
                                            "cubes: use a larger one, or check the unit",
                                            s,
                                            body.name,
                                            solid.max[0] - solid.min[0],
                                            solid.max[1] - solid.min[1],
                                            solid.max[2] - solid.min[2],
                                            most_cubes),
                                "body." + body.name + ".domain_size");
        grid.n[axis] = static_cast<int>(n);
        const bool divides = std::abs(extent - n) <= selection_tolerance;
        grid.origin[axis] =
            divides ? solid.min[axis] : (solid.min[axis] + solid.max[axis] - n * s) / 2;
    }
    return grid;
}

Vec3 sample_point(const CubeGrid& grid, const std::array<int, 3>& cell, int q) {
    constexpr int m = samples_per_edge;
    const auto midpoint = [](int i) { return (i + 0.5) / m; };
    return grid.point(cell[0] + midpoint(q % m),
                      cell[1] + midpoint(q / m % m),
                      cell[2] + midpoint(q / (m * m)));
}

std::vector<FilledCube> fill_cubes(const CubeGrid& grid,
                                   const assets::Solid& solid,
                                   const RegionLayers& regions) {
    struct Row {  // along x, so their order is that of the result
        std::vector<FilledCube> cubes;
        std::vector<Cell> thin;
    };

    std::vector<Row> rows(static_cast<std::size_t>(grid.n[1]) * grid.n[2]);
    tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t row) {
        const int y = static_cast<int>(row % grid.n[1]), z = static_cast<int>(row / grid.n[1]);
        for (int x = 0; x < grid.n[0]; ++x) {
            SampledCube sampled = sample_cube(grid, solid, regions, {x, y, z});
            if (sampled.is_thin)
                rows[row].thin.push_back({x, y, z});
            if (!sampled.is_one_piece) {
                std::vector<FilledCube> parts = fill_finely(grid, solid, regions, {x, y, z});
                if (parts.size() > 1) {
                    std::move(parts.begin(), parts.end(), std::back_inserter(rows[row].cubes));
                    continue;
                }
            }
            if (sampled.cube.filled > 0)
                rows[row].cubes.push_back(std::move(sampled.cube));
        }
    });
    std::vector<FilledCube> cubes;
    std::vector<Cell> thin;
    for (Row& row : rows) {
        std::move(row.cubes.begin(), row.cubes.end(), std::back_inserter(cubes));
        thin.insert(thin.end(), row.thin.begin(), row.thin.end());
    }
    if (thin.empty())
        return cubes;
    const std::vector<Cell> cells = with_neighbours(thin, cubes, grid);
    std::vector<std::vector<FilledCube>> parts(cells.size());
    tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t k) {
        parts[k] = fill_finely(grid, solid, regions, cells[k]);
    });
    return replaced(std::move(cubes), cells, std::move(parts));
}

}  // namespace sim
