// Samples of a cube found by blocks: what is decided for a block is not asked of its samples.
#pragma once

#include "sim/lattice/voxels.h"

#include <cmath>
#include <limits>

namespace sim {

/// A cube of samples: all those of a domain, or an eighth, and so on down to one.
struct Block {
    std::array<int, 3> low{0, 0, 0};  // first sample
    int size = 1;
};

/// How a cube is walked: `samples` per edge, a power of 2. A sample is of interest where its distance is at most `near`,
/// in the body at most `filled`, wholly in it at most `whole`.   [m]
struct Sampling {
    int samples = samples_per_edge;
    double near = 0, filled = 0, whole = 0;
};

/// Calls take(block, region, distance) for blocks inside the body in one region, with distance -infinity, and for single
/// samples of interest, with region -1 where they are not in the body.
template <class Take>
class BlockWalk {
  public:
    BlockWalk(const CubeGrid& grid,
              const assets::Solid& solid,
              const RegionLayers& regions,
              const Sampling& sampling,
              Take take)
        : grid_(grid), solid_(solid), regions_(regions), sampling_(sampling), take_(take) {}

    void walk(const std::array<int, 3>& cell) {
        cell_ = cell;
        walk(Block{{0, 0, 0}, sampling_.samples}, Known{});
    }

  private:
    /// What is known of a block from a larger one: whether it is wholly inside the body, and its only region or -1.
    struct Known {
        bool inside = false;
        int region = -1;
    };

    /// Distances and levels at the middle of a block decide for all of it where they exceed its radius; else its eight
    /// parts are asked. A block of one sample has radius 0 and is always decided.
    void walk(const Block& block, Known known) {
        const double m = sampling_.samples;
        const Vec3 middle =
            Vec3(block.low[0], block.low[1], block.low[2]) + Vec3::Constant(block.size / 2.0);
        const Vec3 X = grid_.point(
            cell_[0] + middle.x() / m, cell_[1] + middle.y() / m, cell_[2] + middle.z() / m);
        // To its outermost samples.
        const double radius = std::sqrt(3.0) * (block.size - 1) / 2 * grid_.edge / m;
        double distance = -std::numeric_limits<double>::infinity();
        if (!known.inside) {
            const double furthest = radius + sampling_.near;
            distance = solid_.distance_up_to(X, furthest);
            if (distance > furthest)
                return;
            known.inside = distance <= sampling_.whole - radius;
        }
        if (block.size == 1) {
            const bool is_filled = known.inside || distance <= sampling_.filled;
            if (is_filled && known.region < 0)
                known.region = regions_.at(X);
            take_(block, is_filled ? known.region : -1, distance);
            return;
        }
        if (known.region < 0)
            known.region = regions_.of_ball(X, radius);
        if (known.inside && known.region >= 0)
            take_(block, known.region, -std::numeric_limits<double>::infinity());
        else
            walk_parts(block, known);
    }

    void walk_parts(const Block& block, const Known& known) {
        const int half = block.size / 2;
        for (int part = 0; part < 8; ++part)
            walk({{block.low[0] + (part & 1 ? half : 0),
                   block.low[1] + (part & 2 ? half : 0),
                   block.low[2] + (part & 4 ? half : 0)},
                  half},
                 known);
    }

    const CubeGrid& grid_;
    const assets::Solid& solid_;
    const RegionLayers& regions_;
    Sampling sampling_;
    Take take_;
    std::array<int, 3> cell_{};
};

/// Calls visit(x, y, z) for the samples of a block.
template <class Visit>
void for_samples(const Block& block, const Visit& visit) {
    const auto& [x, y, z] = block.low;
    for (int k = z; k < z + block.size; ++k)
        for (int j = y; j < y + block.size; ++j)
            for (int i = x; i < x + block.size; ++i)
                visit(i, j, k);
}

}  // namespace sim
