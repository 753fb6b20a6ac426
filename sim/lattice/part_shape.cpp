#include "sim/lattice/part_shape.h"

#include "sim/lattice/block_walk.h"

#include <algorithm>

namespace sim {

namespace {

constexpr int m = fine_per_edge;
constexpr double samples_per_cell = 1.0 * samples_per_cube / (m * m * m);
constexpr double least_part = 1e-4 * samples_per_cube;  // [samples]

// A cell holds material where the distance at its middle is at most this, in cells. Slightly less than half a cell, so
// that what ends at a face of the cube does not reach into the next.
constexpr double holds = 0.45;

int index_of(int x, int y, int z) {
    return x + m * (y + m * z);
}

/// The fine cells of one cube.
class FineCells {
  public:
    /// The region of each cell that holds material, -1 elsewhere, and how much of it is filled.
    void sample(const CubeGrid& grid,
                const assets::Solid& solid,
                const RegionLayers& regions,
                const std::array<int, 3>& cell) {
        region_.assign(m * m * m, -1);
        amount_.assign(m * m * m, 0);
        const double h = grid.edge / m;
        const auto take = [&](const Block& block, int region, double distance) {
            // A plane across an axis of the cell fills this fraction, and any plane does on average.
            const double amount = std::min(1.0, 0.5 - distance / h);
            for_samples(block, [&](int x, int y, int z) {
                region_[index_of(x, y, z)] = region;
                amount_[index_of(x, y, z)] = amount;
            });
        };
        BlockWalk(grid, solid, regions, {m, holds * h, holds * h, -h / 2}, take).walk(cell);
    }

    /// The cells connected face to face with the first that is left, taken out; empty where none is left.
    const std::vector<int>& next_part() {
        part_.clear();
        for (; first_ < m * m * m && part_.empty(); ++first_)
            take(first_);
        for (std::size_t i = 0; i < part_.size(); ++i) {
            const int c = part_[i];
            const int at[3] = {c % m, c / m % m, c / (m * m)};
            for (int axis = 0, stride = 1; axis < 3; ++axis, stride *= m) {
                if (at[axis] > 0)
                    take(c - stride);
                if (at[axis] < m - 1)
                    take(c + stride);
            }
        }
        return part_;
    }

    void begin_parts() {
        first_ = 0;
        taken_.assign(m * m * m, 0);
    }

    int region(int c) const { return region_[c]; }

    double amount(int c) const { return amount_[c]; }

  private:
    void take(int c) {
        if (region_[c] < 0 || taken_[c])
            return;
        taken_[c] = 1;
        part_.push_back(c);
    }

    std::vector<int> region_, part_;
    std::vector<double> amount_;
    std::vector<char> taken_;
    int first_ = 0;
};

std::unique_ptr<const PartShape> shape_of(const std::vector<int>& cells) {
    auto shape = std::make_unique<PartShape>();
    constexpr int per_block = m / PartBlocks::per_edge;
    for (const int c : cells) {
        const int at[3] = {c % m, c / m % m, c / (m * m)};
        shape->blocks.set(at[0] / per_block, at[1] / per_block, at[2] / per_block);
        for (int axis = 0; axis < 3; ++axis)
            if (const bool is_high = at[axis] == m - 1; is_high || at[axis] == 0)
                shape->faces[2 * axis + is_high][at[(axis + 2) % 3]] |= std::uint32_t{1}
                                                                        << at[(axis + 1) % 3];
    }
    return shape;
}

}  // namespace

std::vector<FilledCube> fill_finely(const CubeGrid& grid,
                                    const assets::Solid& solid,
                                    const RegionLayers& regions,
                                    const std::array<int, 3>& cell) {
    thread_local FineCells cells;
    cells.sample(grid, solid, regions, cell);
    cells.begin_parts();
    std::vector<FilledCube> parts;
    std::vector<double> cells_of_region;
    while (true) {
        const std::vector<int>& of_part = cells.next_part();
        if (of_part.empty())
            return parts;
        cells_of_region.clear();
        Vec3 moment = Vec3::Zero();
        for (const int c : of_part) {
            const auto r = static_cast<std::size_t>(cells.region(c));
            cells_of_region.resize(std::max(cells_of_region.size(), r + 1), 0);
            cells_of_region[r] += cells.amount(c);
            moment +=
                cells.amount(c) * (Vec3(c % m, c / m % m, c / (m * m)) + Vec3::Constant(0.5));
        }
        FilledCube part;
        part.cell = cell;
        part.moment = moment * (samples_per_cell * samples_per_edge / m);
        for (std::size_t r = 0; r < cells_of_region.size(); ++r)
            if (cells_of_region[r] > 0)
                part.add(static_cast<int>(r), cells_of_region[r] * samples_per_cell);
        if (part.filled < least_part)
            continue;
        if (part.filled == samples_per_cube)
            part.faces.fill(~std::uint64_t{0});
        else
            part.shape = shape_of(of_part);
        parts.push_back(std::move(part));
    }
}

// Of a cube sampled regularly: it sees nothing finer than its samples, so what comes within half a sample's diagonal of
// a face, in fine cells, counts as there. Else slivers without a sample of their own would cut a smooth body.
constexpr double reaches = 0.87 * fine_per_edge / samples_per_edge;

FaceMask face_mask(const CubeGrid& grid,
                   const assets::Solid& solid,
                   const std::array<int, 3>& cell,
                   int face) {
    FaceMask mask{};
    const int axis = face / 2, along_u = (axis + 1) % 3, along_v = (axis + 2) % 3;
    const double near = reaches * grid.edge / m;
    std::array<double, 3> at;
    at[axis] = cell[axis] + (face % 2 ? m - 0.5 : 0.5) / m;
    for (int v = 0; v < m; ++v)
        for (int u = 0; u < m; ++u) {
            at[along_u] = cell[along_u] + (u + 0.5) / m;
            at[along_v] = cell[along_v] + (v + 0.5) / m;
            if (solid.distance_up_to(grid.point(at[0], at[1], at[2]), near) <= near)
                mask[v] |= std::uint32_t{1} << u;
        }
    return mask;
}

PartBlocks part_blocks(const CubeGrid& grid,
                       const assets::Solid& solid,
                       const std::array<int, 3>& cell) {
    PartBlocks blocks;
    constexpr int n = PartBlocks::per_edge;
    const double near = holds * grid.edge / n;
    for_samples({{0, 0, 0}, n}, [&](int x, int y, int z) {
        const Vec3 X = grid.point(
            cell[0] + (x + 0.5) / n, cell[1] + (y + 0.5) / n, cell[2] + (z + 0.5) / n);
        if (solid.distance_up_to(X, near) <= near)
            blocks.set(x, y, z);
    });
    return blocks;
}

}  // namespace sim
