// The region layers of a body: later wins.
#pragma once

#include "sim/lattice/selection.h"

#include <vector>

namespace sim {

class RegionLayers {
  public:
    /// Throws Error(Input) where there is no region, the first does not select all, or a selector cannot be used.
    RegionLayers(const Body& body, LevelMaker& maker);

    /// The region of a rest point: the last layer that selects it.
    int at(const Vec3& X) const;

    /// The region of a whole ball, or -1 where it may hold several.
    int of_ball(const Vec3& center, double radius) const;

    /// Whether a layer selects a rest point, hidden by a later one or not.
    bool selects(int region, const Vec3& X) const { return level_[region](X) <= tolerance_; }

  private:
    std::vector<Level> level_;  // (#regions)
    double tolerance_;          // [m]
};

}  // namespace sim
