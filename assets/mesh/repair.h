// Holes of a surface: found, measured, closed.
#pragma once

#include "assets/mesh/edges.h"
#include "assets/mesh/triangle_mesh.h"

#include <string>
#include <vector>

namespace assets {

/// A simple loop of edges with one triangle each.
struct Hole {
    std::vector<EdgeUse> edges;  // head to tail, each as its triangle runs
    Vec3 center{0, 0, 0};        // of the edges, weighted by their length [m]
    double size = 0;             // diagonal of the loop's bounding box [m]
    double unevenness = 0;       // largest distance of its vertices from their mean plane [m]
};

/// Number of edges with exactly one triangle.
int boundary_edge_count(const TriangleMesh& mesh);

/// The holes, in a fixed order. Boundary edges that form no loop, because
/// neighbours face oppositely or more than two triangles meet, are in none. Requires triangles with
/// three distinct vertices.
std::vector<Hole> find_holes(const TriangleMesh& mesh);

/// The mesh with every hole closed by a fan of triangles about its centre, a new vertex; they face
/// as their neighbours do and belong to their groups. Adds one sentence per hole to `repairs`, and
/// one for edges that remain open. Requires triangles with three distinct vertices.
TriangleMesh close_holes(const TriangleMesh& mesh, std::vector<std::string>* repairs);

/// Mean of the points of the edges of a loop.   [m]
Vec3 loop_center(const TriangleMesh& mesh, const std::vector<EdgeUse>& loop);

}  // namespace assets
