// Polygons of files into triangles.
#pragma once

#include "assets/base/vector_types.h"

#include <array>
#include <span>
#include <vector>

namespace assets {

/// Cuts a polygon (n ≥ 3 corners in order, nearly flat, convex or not) into its n - 2 triangles by
/// clipping ears in the plane of its mean normal; they keep its direction. Where a crossing or flat
/// polygon has no ear, the next corner is cut all the same.   (indices of corners)
std::vector<std::array<int, 3>> triangulate(std::span<const Vec3> corners);

}  // namespace assets
