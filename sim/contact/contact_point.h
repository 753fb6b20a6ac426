// A vertex that touches, or may touch, the inside of a body: its depth, linear in the corners.
#pragma once

#include "sim/contact/contact_surface.h"

namespace sim {

/// With p the vertex and o the point of the domain that it has met, both sums over eight corners with weights that sum
/// to 1, it is as far from the body as  gap + n·(p - o),  n = F^-T grad phi / |F^-T grad phi|,  gap = phi / |F^-T grad phi|:
/// the rest distance phi as it is stretched today, linearised at p = o.
struct ContactPoint {
    const ContactVertex* vertex = nullptr;
    std::array<int, 8> corners{};  // of the domain, in the field of all corners
    std::array<double, 8> weights{};
    double gap = 0;        // [m]
    Vec3 normal{0, 0, 1};  // n
    double edge = 0;       // of the domain at rest [m]

    /// p - o of a field of corners.
    Vec3 separation(const Field& x) const {
        Vec3p sum{};
        for (int a = 0; a < 8; ++a)
            sum += vertex->weights[a] * x[vertex->corners[a]] - weights[a] * x[corners[a]];
        return unpadded(sum);
    }

    /// The transpose: adds f at p and -f at o.
    void scatter(const Vec3& f, Field& field) const {
        const Vec3p force = padded(f);
        for (int a = 0; a < 8; ++a) {
            field[vertex->corners[a]] += vertex->weights[a] * force;
            field[corners[a]] -= weights[a] * force;
        }
    }

    /// Inside it, positive; 0 outside.   [m]
    double depth(const Vec3& apart) const { return std::max(0.0, -(gap + normal.dot(apart))); }
};

}  // namespace sim
