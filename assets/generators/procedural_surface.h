// Triangle meshes of procedural shapes, before any transform.
#pragma once

#include "assets/generators/shape.h"
#include "assets/mesh/triangle_mesh.h"

namespace assets {

/// Exact: every face in a grid of equal rectangles whose edges are no longer than `spacing`; faces share the
/// vertices of their common edges.   [m]
TriangleMesh box_surface(const Box& box, double spacing);

/// From an OpenVDB level set of voxels of `spacing`, the vertices moved onto the surface, and onto its edges and corners
/// where it has such: these are edges of the mesh.   [m]
TriangleMesh curved_surface(const Shape& shape, double spacing);

}  // namespace assets
