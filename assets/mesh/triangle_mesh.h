// A surface of triangles with named groups.
#pragma once

#include "assets/base/vector_types.h"

#include <array>
#include <string>
#include <vector>

namespace assets {

struct TriangleMesh {
    std::vector<Vec3> positions;                // (#V) [m]
    std::vector<std::array<int, 3>> triangles;  // (#T) vertices, counter-clockwise from outside
    std::vector<int> triangle_group;            // (#T) index into groups; empty where groups is
    std::vector<std::string> groups;            // material or group names of the file
};

/// Volume enclosed by a closed mesh, Σ_t a·(b×c)/6, positive if its triangles face outwards.   [m³]
double signed_volume(const TriangleMesh& mesh);

/// Area-weighted vertex normals, unit length; zero where a vertex has no area around it.   (#V)
std::vector<Vec3> vertex_normals(const TriangleMesh& mesh);

}  // namespace assets
