// Meshes with crisp edges: one vertex per smooth side of a crease.
#pragma once

#include "assets/mesh/triangle_mesh.h"

#include <array>
#include <vector>

namespace sim {

struct CreasedMesh {
    std::vector<Vec3> positions;  // (#V) [m]
    std::vector<Vec3> normals;    // (#V) unit, triangles weighted by their angle at the vertex
    std::vector<std::array<int, 3>> triangles;  // (#T) in the order of the mesh
};

/// Splits vertices along edges where two faces meet at more than `crease_angle` [rad], and along edges that do not
/// have exactly two triangles. Vertices without triangles are dropped.
CreasedMesh split_creases(const assets::TriangleMesh& mesh, double crease_angle);

}  // namespace sim
