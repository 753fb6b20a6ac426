// Fields over the corners of a lattice, and what they deform it by.
#pragma once

#include "sim/base/field.h"
#include "sim/lattice/lattice.h"

namespace tests {

/// Corners where F takes them from rest, and a shift.
inline sim::Field corners_at(const sim::Lattice& lattice,
                             const Mat3& F = Mat3::Identity(),
                             const Vec3& shift = Vec3::Zero()) {
    sim::Field x;
    for (const Vec3& X : lattice.corner_rest)
        x.push_back(sim::padded(F * X + shift));
    return x;
}

/// F of a domain at local coordinates t in [0,1]³, written out from the trilinear shape functions.
inline Mat3 gradient_at(const sim::Lattice& lattice,
                        int p,
                        const sim::Field& x,
                        const Vec3& t) {
    Mat3 F = Mat3::Zero();
    for (int a = 0; a < 8; ++a)
        for (int j = 0; j < 3; ++j) {
            double slope = 1 / lattice.edge;
            for (int k = 0; k < 3; ++k)
                slope *= k == j ? ((a >> k & 1) ? 1 : -1) : ((a >> k & 1) ? t[k] : 1 - t[k]);
            F.col(j) += slope * sim::unpadded(x[lattice.corners[p][a]]);
        }
    return F;
}

}  // namespace tests
