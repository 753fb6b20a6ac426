// Vertices at the same place made one, and triangles that add nothing dropped.
#pragma once

#include "assets/mesh/triangle_mesh.h"

#include <string>
#include <vector>

namespace assets {

/// Vertices nearer to each other than this part of the diagonal of the mesh's bounding box are one
/// vertex.
constexpr double weld_fraction = 1e-6;

/// Diagonal of the bounding box of the vertices that triangles use.   [m]
double used_diagonal(const TriangleMesh& mesh);

/// Merges every vertex into the first within `tolerance` [m] of it and drops those that no triangle
/// uses; the order stays. Merged vertices at exactly the same place are not told, since formats
/// repeat vertices along seams; nearly equal ones are.
void weld(TriangleMesh& mesh, double tolerance, std::vector<std::string>* repairs);

/// Drops triangles with a vertex twice, and those lower than `tolerance` [m] unless they close the
/// surface.
void drop_degenerate(TriangleMesh& mesh, double tolerance, std::vector<std::string>* repairs);

/// Of triangles on the same three vertices, whichever way they face, keeps the first.
void drop_doubled(TriangleMesh& mesh, std::vector<std::string>* repairs);

}  // namespace assets
