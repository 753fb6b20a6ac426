// Which corners of triangles stay one vertex where a mesh is split along its creases.
#pragma once

#include <array>
#include <functional>
#include <vector>

namespace assets {

/// For each corner, numbered 3 t + k, the lowest that is joined with it: those at a vertex are joined across an edge that
/// exactly two triangles t < u have, where is_smooth(t, u). Each triangle has three distinct vertices. (3 #T)
std::vector<int> joined_corners(const std::vector<std::array<int, 3>>& triangles,
                                const std::function<bool(int, int)>& is_smooth);

}  // namespace assets
