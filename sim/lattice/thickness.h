// Where a body is thinner than its domains.
#pragma once

#include "assets/generators/solid.h"

#include <vector>

namespace sim {

/// Finds surface points at thin parts of a solid: those from which no ball of radius `depth` in the solid is reached
/// whose middle lies within 2.5 times that. So plates, fibres and sharp wedges are thin, and edges of thick boxes are not.
/// The search climbs the distance, and remembers balls: neighbours of thick places cost nothing.
class Thickness {
  public:
    /// `depth` [m]
    Thickness(const assets::Solid& solid, double depth) : solid_(solid), depth_(depth) {}

    /// `distance`: signed, at X [m].
    bool is_thin_at(const Vec3& X, double distance);

  private:
    struct Ball {
        Vec3 middle;
        double radius;  // [m]
    };

    bool remember(const Vec3& middle);
    bool climb(const Vec3& X, double distance);

    const assets::Solid& solid_;
    double depth_;
    std::vector<Ball> balls_;
};

}  // namespace sim
