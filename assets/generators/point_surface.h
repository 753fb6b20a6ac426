// The surface around a cloud of points, such as those of snow: an OpenVDB level set, and triangles on it.
#pragma once

#include "assets/base/vector_types.h"

#include <array>
#include <string>
#include <vector>

namespace assets {

/// One smooth skin around points that are neighbours, and a small ball around each that has left the others.
struct PointSurface {
    std::vector<Vec3f> positions;  // (#V) [m]
    std::vector<Vec3f> normals;    // (#V) unit, along the field's gradient, outwards
    std::vector<std::array<int, 3>> triangles;  // (#T) counter-clockwise from outside; closed
    // An OpenVDB file: φ in metres, a level set named "surface", a voxel to each side.
    std::string vdb;
};

/// `spacing` is the distance of neighbours in the cloud at rest, the cube root of the volume that a point stands
/// for   [m]. The surface is where
///
///   φ(x) = max(|x - x̄(x)| - r, min_p |x - x_p| - c) = 0,   [Zhu & Bridson 2005, Animating sand as a fluid]
///
/// with x̄ the mean of the points around x under a smooth kernel; the second term keeps apart what the mean alone would
/// bridge. The radius r is such that a flat side of a dense cloud lies half a spacing outside of its outermost points:
/// a block of n points encloses about n spacing³. Gaps of less than about a spacing are closed. Away from the surface φ
/// is no distance: its sign alone counts there.
///
/// Voxels lie still in space, so that the surface moves as evenly as the points do. The same bytes for any number of
/// threads. std::logic_error where a position is not finite or the spacing is not positive.
PointSurface point_surface(const std::vector<Vec3>& points, double spacing);

}  // namespace assets
