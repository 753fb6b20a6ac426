// Sharp edges stay sharp: vertices on them are split, so that each side keeps its own shading normal.
#pragma once

#include "assets/base/vector_types.h"

#include <array>
#include <vector>

namespace render {

/// A surface's triangles after the split. A vertex off the edges keeps its identity and its given normal.
struct SplitTopology {
    std::vector<std::array<int, 3>> triangles;  // (#T) into the split vertices
    std::vector<int> source;      // (#S) the given vertex behind each split vertex
    std::vector<bool> on_crease;  // (#S)
};

/// Splits where two triangles meet at more than `crease_angle_deg` in the rest shape.
SplitTopology split_creases(const std::vector<std::array<int, 3>>& triangles,
                            const std::vector<Vec3f>& rest_positions,
                            float crease_angle_deg = 40);

/// Normals of the split vertices: those given, but on creases the mean of the triangles around, weighted by area.
std::vector<Vec3f> split_normals(const SplitTopology& topology,
                                 const std::vector<Vec3f>& positions,
                                 const std::vector<Vec3f>& normals);

}  // namespace render
