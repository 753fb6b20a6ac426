// What surface contact knows of a body: vertices that touch, and the inside that they may not enter.
#pragma once

#include "assets/generators/distance_field.h"
#include "sim/base/field.h"
#include "sim/embedding/cell_index.h"
#include "sim/lattice/lattice.h"

#include <array>
#include <vector>

namespace sim {

/// A point of the body's surface, carried by the corners of its domain.
struct ContactVertex {
    Vec3 rest{0, 0, 0};               // [m]
    int domain = 0;                   // that carries it
    std::array<int, 8> corners{};     // in the field of all corners
    std::array<double, 8> weights{};  // sum to 1
    double area = 0;                  // of the surface that it stands for, at rest [m²]
    double young_modulus = 0;         // there [Pa]
    double wave_speed = 0;            // sqrt(E / rho) there [m/s]

    /// Now, from the field of all corners.   [m]
    Vec3p padded_position(const Field& x) const {
        Vec3p sum{};
        for (int a = 0; a < 8; ++a)
            sum += weights[a] * x[corners[a]];
        return sum;
    }

    Vec3 position(const Field& x) const { return unpadded(padded_position(x)); }
};

/// Of a body with itself domains this near a vertex at rest are left out, in domain edges.
constexpr double neighbourhood = 2.5;

struct ContactSurface {
    /// Corners of the body begin at `first_corner` in the field of all corners. `lattice` outlives the surface. The
    /// vertices are about two per domain edge, those of the mesh first, so that they keep its corners.
    ContactSurface(const Body& body, const Lattice& body_lattice, int first_corner, int index);

    std::vector<ContactVertex> vertices;
    assets::DistanceField distance;  // at rest
    double largest_weight_sum = 1;  // of a vertex, without signs: more than 1 beyond its domain
    double thickness = 0;           // smallest extent of its bounds [m]
    const Lattice* lattice = nullptr;
    int scene_body = 0;      // index of the body in the scene
    int begin = 0;           // of its corners in the field of all corners
    CellIndex cells;         // of the lattice
    std::vector<int> shell;  // domains that a vertex may be found in before it is pushed out

    /// At rest.   [m]
    Vec3 domain_centre(int p) const;

    /// Now, from the field of all corners x.   (8) [m]
    std::array<Vec3p, 8> domain_corners(int p, const Field& x) const;

    std::vector<int> all_vertices() const;  // 0, 1, 2...
};

}  // namespace sim
