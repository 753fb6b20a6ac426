// Distances from points to the triangles of a mesh.
#pragma once

#include "assets/mesh/triangle_mesh.h"

#include <array>
#include <vector>

namespace assets {

/// A binary tree of boxes around triangles.
class TriangleTree {
  public:
    /// `triangles` numbers those of the mesh that count; at least one.
    TriangleTree(const TriangleMesh& mesh, const std::vector<int>& triangles);

    /// Distance to the nearest of the triangles.   [m]
    double distance(const Vec3& x) const;

  private:
    struct Node {
        Vec3 min{0, 0, 0}, max{0, 0, 0};
        int begin = 0, end = 0;  // its triangles
        int second_child = 0;    // the first follows its parent; 0 in a leaf
    };

    using Corners = std::array<Vec3, 3>;

    void build(int begin, int end);

    std::vector<Corners> triangles_;
    std::vector<Node> nodes_;
};

/// Squared distance from x to the triangle abc.   [m²]
double squared_distance(const Vec3& x, const std::array<Vec3, 3>& triangle);

}  // namespace assets
