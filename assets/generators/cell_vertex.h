// Where the vertex of a cell lies on the surface of a shape.
#pragma once

#include "assets/generators/shape.h"

namespace assets {

struct CellVertex {
    Vec3 position{0, 0, 0};  // [m]
    bool is_sharp = false;   // on an edge or corner of the shape
};

/// The point of the surface that stands for what passes through the cube [low, low + edge]³: where faces meet in it, a
/// point of their edge or their corner, else that nearest to `guess`. Found by the planes that touch the surface where
/// the cube's edges cross it; their common point is the least Σ (n·(x - p))².   [m]
/// [Kobbelt et al. 2001, Feature sensitive surface extraction; Ju et al. 2002, Dual contouring of Hermite data]
CellVertex cell_vertex(const Shape& shape, const Vec3& low, double edge, const Vec3& guess);

}  // namespace assets
