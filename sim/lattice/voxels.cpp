#include "sim/lattice/voxels.h"

#include "assets/base/error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace sim {

namespace {

// Above this a run would neither fit in memory nor end: a slip of the unit in domain_size, most likely.
constexpr double most_cubes = 3e8;

/// Adds `count` samples of a region around `middle`, keeping regions ascending.
void add_samples(FilledCube& cube, int region, int count, const Vec3& middle) {
    auto at = std::lower_bound(cube.samples.begin(), cube.samples.end(), std::pair(region, 0));
    if (at == cube.samples.end() || at->first != region)
        at = cube.samples.insert(at, {region, 0});
    at->second += count;
    cube.filled += count;
    cube.moment += count * middle;
}

/// A cube of samples: all those of a domain, or an eighth, and so on down to one.
struct Block {
    std::array<int, 3> low{0, 0, 0};  // first sample
    int size = samples_per_edge;
};

/// What is known of a block from a larger one: whether it is wholly inside the body, and its only region or -1.
struct Known {
    bool inside = false;
    int region = -1;
};

class CubeFiller {
  public:
    CubeFiller(const CubeGrid& grid, const assets::Solid& solid, const RegionLayers& regions)
        : grid_(grid), solid_(solid), regions_(regions) {}

    FilledCube fill(const std::array<int, 3>& cell) const {
        FilledCube cube{cell, 0, Vec3::Zero(), {}};
        fill(Block{}, Known{}, cube);
        return cube;
    }

  private:
    /// Distances and levels at the middle of a block decide for all of it where they exceed its radius; else its eight
    /// parts are asked. A block of one sample has radius 0 and is always decided.
    void fill(const Block& block, Known known, FilledCube& cube) const {
        constexpr double m = samples_per_edge;
        const Vec3 middle =
            Vec3(block.low[0], block.low[1], block.low[2]) + Vec3::Constant(block.size / 2.0);
        const Vec3 X = grid_.point(cube.cell[0] + middle.x() / m,
                                   cube.cell[1] + middle.y() / m,
                                   cube.cell[2] + middle.z() / m);
        const double radius =
            std::sqrt(3.0) * (block.size - 1) / 2 * grid_.edge / m;  // to its outermost samples
        if (!known.inside) {
            const double distance = solid_.signed_distance(X);
            if (distance > radius)
                return;
            known.inside = distance <= -radius;
        }
        if (known.region < 0)
            known.region = block.size == 1 ? regions_.at(X) : regions_.of_ball(X, radius);
        if (known.inside && known.region >= 0)
            add_samples(cube, known.region, block.size * block.size * block.size, middle);
        else
            fill_parts(block, known, cube);
    }

    void fill_parts(const Block& block, const Known& known, FilledCube& cube) const {
        const int half = block.size / 2;
        for (int part = 0; part < 8; ++part)
            fill({{block.low[0] + (part & 1 ? half : 0),
                   block.low[1] + (part & 2 ? half : 0),
                   block.low[2] + (part & 4 ? half : 0)},
                  half},
                 known,
                 cube);
    }

    const CubeGrid& grid_;
    const assets::Solid& solid_;
    const RegionLayers& regions_;
};

}  // namespace

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
    const CubeFiller filler(grid, solid, regions);
    const int n_rows = grid.n[1] * grid.n[2];
    std::vector<std::vector<FilledCube>> rows(
        n_rows);  // each along x, so their order is that of the result
    tbb::parallel_for(0, n_rows, [&](int row) {
        for (int x = 0; x < grid.n[0]; ++x) {
            FilledCube cube = filler.fill({x, row % grid.n[1], row / grid.n[1]});
            if (cube.filled > 0)
                rows[row].push_back(std::move(cube));
        }
    });
    std::vector<FilledCube> cubes;
    for (std::vector<FilledCube>& row : rows)
        std::move(row.begin(), row.end(), std::back_inserter(cubes));
    return cubes;
}

}  // namespace sim
