// The distance of a collider that has no formula: of a mesh, an ellipsoid, a combined shape.
#pragma once

#include "assets/generators/distance_field.h"
#include "assets/generators/solid.h"

#include <memory>

namespace sim {

struct ColliderField {
    std::shared_ptr<const assets::DistanceField> distance;
    double voxel = 0;  // of its values [m]
};

/// A field by voxels of a quarter of `resolution` [m], where bodies' domains see details, or finer where the source would have
/// parts without an inside: means over three voxels blur a wall thinner than one and a half away, and bodies pass. As exact up
/// to `reach` [m] outside as inside. `coarse` is the source's solid, for its bounds. Throws
/// Error(Input) where that takes more than 2e8 voxels.
ColliderField collider_field(const assets::Source& source,
                             const assets::Solid& coarse,
                             double resolution,
                             double reach);

}  // namespace sim
