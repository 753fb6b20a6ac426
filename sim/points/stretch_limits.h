// Whether the stretches of points keep to limits, without finding them.
#pragma once

#include "sim/materials/lanes.h"
#include "sim/materials/polar.h"

#include <limits>

namespace sim {

template <class S>
[[gnu::always_inline]] inline S smaller(const S& a, const S& b) {
    return select_positive(S(b - a), a, b);
}

/// Positive where the symmetric A has positive eigenvalues alone: the first pivot of its LDLᵀ that is not positive, else
/// the last. Elimination without exchanges is stable there: it is wrong by no more than the rounding of A.
template <class S>
[[gnu::always_inline]] inline S positive_definite(const Matrix3<S>& A) {
    const S first = A.m[0], x = A.m[1] / first, y = A.m[2] / first;
    const S second = A.m[4] - x * A.m[1], yz = A.m[5] - x * A.m[2];
    const S third = A.m[8] - y * A.m[2] - yz * yz / second;
    return select_positive(first, select_positive(second, third, second), first);
}

struct StretchLimits {
    double low = 0, high = std::numeric_limits<double>::infinity();
};

/// Positive where no stretch of F is outside of [low, high] and F keeps its side: low² 1 < FᵀF < high² 1.
template <class S>
[[gnu::always_inline]] inline S inside(const Matrix3<S>& F, const S& low, const S& high) {
    Matrix3<S> above = gram(F), below;
    for (int k = 0; k < 9; ++k)
        below.m[k] = -above.m[k];
    for (int k = 0; k < 9; k += 4) {
        above.m[k] -= low * low;
        below.m[k] += high * high;
    }
    return smaller(smaller(positive_definite(above), positive_definite(below)), determinant(F));
}

}  // namespace sim
