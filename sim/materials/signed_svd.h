// Singular value decomposition with rotations on both sides.
#pragma once

#include "assets/base/vector_types.h"

namespace sim {

/// F = U diag(sigma) V^T with U and V rotations (det = +1) and sigma_0 >= sigma_1 >= |sigma_2|, the
/// last carrying the sign of det F [ITF04 §4].
struct SignedSvd {
    Mat3 U;
    Vec3 sigma;  // the principal stretches, if F is a deformation gradient [–]
    Mat3 V;
};

/// Holds for repeated and zero singular values. Requires finite entries, else throws std::logic_error.
SignedSvd signed_svd(const Mat3& F);

}  // namespace sim
