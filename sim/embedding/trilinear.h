// The trilinear map of a domain's cube.
#pragma once

#include "sim/embedding/embedding.h"

#include <array>

namespace sim {

/// N_a at local coordinates xi, 0..1 inside: the product over axes of xi or 1 - xi.   (8)
inline std::array<double, 8> trilinear_weights(const Vec3& xi) {
    std::array<double, 8> weights;
    for (int a = 0; a < 8; ++a)
        weights[a] = (a & 1 ? xi.x() : 1 - xi.x()) * (a & 2 ? xi.y() : 1 - xi.y())
                     * (a & 4 ? xi.z() : 1 - xi.z());
    return weights;
}

/// The local coordinates that have these weights: the trilinear map reproduces coordinates.
inline Vec3 local_coordinates(const std::array<double, 8>& w) {
    return {w[1] + w[3] + w[5] + w[7], w[2] + w[3] + w[6] + w[7], w[4] + w[5] + w[6] + w[7]};
}

/// ∂x/∂X at xi of a cube of edge s whose corners are now at x: differences along each axis, interpolated over the
/// other two.   (3×3)
inline Mat3 trilinear_gradient(const Vec3& xi, double s, const std::array<Vec3, 8>& x) {
    const double u = xi.x(), v = xi.y(), w = xi.z();
    const Vec3 along_x = (1 - w) * ((1 - v) * (x[1] - x[0]) + v * (x[3] - x[2]))
                         + w * ((1 - v) * (x[5] - x[4]) + v * (x[7] - x[6]));
    const Vec3 along_y = (1 - w) * ((1 - u) * (x[2] - x[0]) + u * (x[3] - x[1]))
                         + w * ((1 - u) * (x[6] - x[4]) + u * (x[7] - x[5]));
    const Vec3 along_z = (1 - v) * ((1 - u) * (x[4] - x[0]) + u * (x[5] - x[1]))
                         + v * ((1 - u) * (x[6] - x[2]) + u * (x[7] - x[3]));
    Mat3 F;
    F << along_x / s, along_y / s, along_z / s;
    return F;
}

/// Where the corners of a domain are now.   (8)
inline std::array<Vec3, 8> corners_of(const Lattice& lattice,
                                      int domain,
                                      std::span<const Vec3> corners) {
    std::array<Vec3, 8> x;
    for (int a = 0; a < 8; ++a)
        x[a] = corners[lattice.corners[domain][a]];
    return x;
}

}  // namespace sim
