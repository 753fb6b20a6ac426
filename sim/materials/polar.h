// The rotation R nearest to F: F = RS with S symmetric and det R = +1, also where F is inverted.
#pragma once

#include "sim/materials/lanes.h"

namespace sim {

/// R = U V^T of the signed singular value decomposition: holds for every F, slowly. NaN if F is not finite.
Matrix3<double> nearest_rotation_by_svd(const Matrix3<double>& F);

/// A rotation and whether it can be trusted: where `trust` is not positive, it cannot.
template <class S>
struct RotationGuess {
    Matrix3<S> R;
    S trust;
};

/// R in closed form from x = tr S [M93 eq. 21],
///   R = ((κ + ‖F‖²) F + xC − F F^T F)/ζ,  κ = (x² − ‖F‖²)/2,  ζ = κx − J = Π (σ_i + σ_j),  C = ∂J/∂F,
/// x being the largest root of (x² − ‖F‖²)² − 8Jx − 4‖C‖²: Newton descends to it from √3 ‖F‖ >= tr S.
/// An error of x leaves the axes of R right and only stretches it, which R (3I − R^T R)/2 undoes.
/// Trusted unless x has not settled or two stretches nearly cancel, which magnifies the rounding.
template <class S>
[[gnu::always_inline]] inline RotationGuess<S> nearest_rotation_guess(const Matrix3<S>& F);

/// A^T A.
template <class S>
[[gnu::always_inline]] inline Matrix3<S> gram(const Matrix3<S>& A) {
    const auto dot = [&](int i, int j) __attribute__((always_inline)) {
        const S *const a = A.m + 3 * i, *const b = A.m + 3 * j;
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    const S xy = dot(0, 1), yz = dot(1, 2), zx = dot(2, 0);
    return {{dot(0, 0), xy, zx, xy, dot(1, 1), yz, zx, yz, dot(2, 2)}};
}

/// A B.
template <class S>
[[gnu::always_inline]] inline Matrix3<S> product(const Matrix3<S>& A, const Matrix3<S>& B) {
    Matrix3<S> result;
#pragma GCC unroll 9
    for (int n = 0; n < 9; ++n) {
        const int i = n % 3, j = n / 3;
        result.m[n] =
            A.m[i] * B.m[3 * j] + A.m[3 + i] * B.m[3 * j + 1] + A.m[6 + i] * B.m[3 * j + 2];
    }
    return result;
}

template <class S>
[[gnu::always_inline]] inline RotationGuess<S> nearest_rotation_guess(const Matrix3<S>& F) {
    constexpr int most_newton_steps = 5;  // enough for stretches from 1/2 to 2
    constexpr double settled = 1e-4;  // change of x over ‖F‖: about its square is left then
    constexpr double rounding = 1e-15;  // defect of which a correction leaves an eighth
    const Matrix3<S> C = cofactor(F);
    const S J = determinant(F, C), size_squared = inner(F, F), area_squared = inner(C, C);
    const S size = sqrt_of(size_squared);
    S x = std::sqrt(3.0) * size;
    for (int step = 0; step < most_newton_steps; ++step) {
        const S y = x * x - size_squared;
        const S change = (y * y - 8.0 * J * x - 4.0 * area_squared) / (4.0 * (x * y - 2.0 * J));
        x = x - change;
        if (!(largest_lane(S(change - settled * size)) > 0))
            break;
    }
    const S kappa = 0.5 * (x * x - size_squared), zeta = kappa * x - J;
    const S inverse_zeta = 1.0 / zeta;
    Matrix3<S> R = product(F, gram(F));
    for (int n = 0; n < 9; ++n)
        R.m[n] = ((kappa + size_squared) * F.m[n] + x * C.m[n] - R.m[n]) * inverse_zeta;

    // Two corrections, each squaring what is wrong, or one where that is enough in every lane.
    S defect = uniform<S>(0);  // ‖I − R^T R‖² before the first
    for (int correction = 0; correction < 2; ++correction) {
        Matrix3<S> half = gram(R);
        for (int n = 0; n < 9; ++n)
            half.m[n] = (n % 4 == 0 ? 0.5 : 0.0) - 0.5 * half.m[n];
        const Matrix3<S> change = product(R, half);
        for (int n = 0; n < 9; ++n)
            R.m[n] = R.m[n] + change.m[n];
        if (correction == 0)
            defect = 4.0 * inner(half, half);
        if (!(largest_lane(defect) > rounding))
            break;
    }
    const S separated = zeta - 1e-3 * size_squared * size;
    return {R, select_positive(1e-8 - defect, separated, uniform<S>(-1))};
}

inline Matrix3<double> nearest_rotation(const Matrix3<double>& F) {
    const RotationGuess<double> guess = nearest_rotation_guess(F);
    return guess.trust > 0 ? guess.R : nearest_rotation_by_svd(F);
}

/// The same in every lane.
template <class S>
[[gnu::always_inline]] inline Matrix3<S> nearest_rotation(const Matrix3<S>& F) {
    RotationGuess<S> guess = nearest_rotation_guess(F);
    for (std::size_t lane = 0; lane < sizeof(S) / sizeof(double); ++lane) {
        if (guess.trust[lane] > 0)
            continue;
        Matrix3<double> element;
        for (int n = 0; n < 9; ++n)
            element.m[n] = F.m[n][lane];
        element = nearest_rotation_by_svd(element);
        for (int n = 0; n < 9; ++n)
            guess.R.m[n][lane] = element.m[n];
    }
    return guess.R;
}

}  // namespace sim
