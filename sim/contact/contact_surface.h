// What surface contact knows of a body: vertices that touch, and the inside that they may not enter.
#pragma once

#include "assets/generators/distance_field.h"
#include "sim/lattice/lattice.h"

#include <array>
#include <vector>

namespace sim {

/// A point of the body's surface, carried by the corners of its domain.
struct ContactVertex {
    Vec3 rest{0, 0, 0};               // [m]
    std::array<int, 8> corners{};     // in the field of all corners
    std::array<double, 8> weights{};  // sum to 1
    double area = 0;                  // of the surface that it stands for, at rest [m²]
    double young_modulus = 0;         // there [Pa]
    double wave_speed = 0;            // sqrt(E / rho) there [m/s]
};

struct ContactSurface {
    /// Corners of the body begin at `first_corner` in the field of all corners. The vertices are two to three per domain
    /// edge, those of the mesh first, so that they keep its corners.
    ContactSurface(const Body& body, const Lattice& lattice, int first_corner);

    std::vector<ContactVertex> vertices;
    assets::DistanceField distance;  // at rest
    double thickness = 0;            // smallest extent of its bounds [m]
};

}  // namespace sim
