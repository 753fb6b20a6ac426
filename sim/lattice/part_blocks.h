// Where the material of a part lies in its domain's cube.
#pragma once

#include "assets/base/vector_types.h"

#include <algorithm>
#include <bitset>

namespace sim {

/// Which of 16³ equal blocks of a cube hold material of one part.
class PartBlocks {
  public:
    static constexpr int per_edge = 16;

    void set(int x, int y, int z) { holds_.set(x + per_edge * (y + per_edge * z)); }

    /// Middle of block b in local coordinates of the cube, 0..1, for each block that holds material.
    template <class Visit>
    void for_each(const Visit& visit) const {
        for (std::size_t b = holds_._Find_first(); b < holds_.size(); b = holds_._Find_next(b))
            visit(Vec3(Vec3(b % per_edge, b / per_edge % per_edge, b / (per_edge * per_edge))
                       + Vec3::Constant(0.5))
                  / per_edge);
    }

    /// Squared distance from a point in local coordinates to the nearest block with material.   [domain edges²]
    double squared_distance(const Vec3& xi) const {
        double least = 1e300;
        for_each([&](const Vec3& middle) {
            const Vec3 beyond =
                ((xi - middle).cwiseAbs() - Vec3::Constant(0.5 / per_edge)).cwiseMax(0.0);
            least = std::min(least, beyond.squaredNorm());
        });
        return least;
    }

  private:
    std::bitset<per_edge * per_edge * per_edge> holds_;
};

}  // namespace sim
