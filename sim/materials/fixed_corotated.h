// Fixed corotated law: linear elasticity measured from the nearest rotation, with the true volume.
#pragma once

#include "sim/materials/packed_stiffness.h"
#include "sim/materials/polar.h"
#include "sim/materials/wave_modulus.h"

namespace sim {

/// Ψ(F) = μ ‖F − R‖² + λ/2 (J − 1)²,  F = RS the polar decomposition with det R = +1 [SHST12 §3.4].
/// S is double or Lanes; μ and λ are Lamé's [Pa]. Finite for inverted elements too.
struct FixedCorotated {
    /// Ψ [J/m³].
    template <class S>
    [[gnu::always_inline]] static S energy_density(const Matrix3<S>& F, S mu, S lambda) {
        Matrix3<S> P;
        return energy_and_first_piola(F, mu, lambda, P);
    }

    /// Ψ [J/m³] and, for the work of one, P = ∂Ψ/∂F = 2μ(F − R) + λ(J − 1) ∂J/∂F [Pa].
    template <class S>
    [[gnu::always_inline]] static S energy_and_first_piola(const Matrix3<S>& F,
                                                           S mu,
                                                           S lambda,
                                                           Matrix3<S>& P) {
        const Matrix3<S> C = cofactor(F), R = nearest_rotation(F);
        const S growth = determinant(F, C) - 1.0;
        const S dh = lambda * growth;
        Matrix3<S> strain;
        for (int n = 0; n < 9; ++n) {
            strain.m[n] = F.m[n] - R.m[n];
            P.m[n] = 2.0 * mu * strain.m[n] + dh * C.m[n];
        }
        return mu * inner(strain, strain) + 0.5 * dh * growth;
    }

    /// ∂P/∂F, packed: 2μ(I − ∂R/∂F) + λ vec(C) vec(C)^T + λ(J − 1) ∂C/∂F,  C = ∂J/∂F.   [Pa]
    /// Not finite where two principal stretches sum to zero: the rotation is not unique there.
    template <class S>
    [[gnu::always_inline]] static void stiffness(const Matrix3<S>& F, S mu, S lambda, S* A) {
        const Matrix3<S> C = cofactor(F), R = nearest_rotation(F);
        const S dh = lambda * (determinant(F, C) - 1.0);
        set_stiffness(F, C, 2.0 * mu, dh, lambda, A);
        subtract_rotation_derivative(F, R, 2.0 * mu, A);
    }

    /// rho c² of the fastest wave, from above: rotations only soften, while no two principal stretches sum to less than
    /// zero.   [Pa]
    template <class S>
    [[gnu::always_inline]] static S highest_wave_modulus(const Matrix3<S>& F, S mu, S lambda) {
        return wave_modulus(cofactor(F), S(2.0 * mu), lambda);
    }

  private:
    /// A −= scale ∂R/∂F. A change of R is δR = R [w]×, with (tr S I − S) w the axial vector of
    /// R^T δF − δF^T R, so  ∂R/∂F = Σ_ab (tr S I − S)⁻¹_ab q_a q_b^T,  q_a = vec(R [e_a]×).
    template <class S>
    [[gnu::always_inline]] static void subtract_rotation_derivative(const Matrix3<S>& F,
                                                                    const Matrix3<S>& R,
                                                                    S scale,
                                                                    S* A) {
        const Matrix3<S> inverse = twist_inverse(F, R);
        S q[3][9], w[3][9];  // w_a = scale Σ_b (tr S I − S)⁻¹_ab q_b
#pragma GCC unroll 3
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
#pragma GCC unroll 3
            for (int i = 0; i < 3; ++i) {
                q[a][3 * a + i] = uniform<S>(0);
                q[a][3 * b + i] = R.m[3 * c + i];
                q[a][3 * c + i] = -R.m[3 * b + i];
            }
        }
#pragma GCC unroll 27
        for (int n = 0; n < 27; ++n) {
            const int a = n / 9, r = n % 9;
            w[a][r] = scale
                      * (inverse.m[a] * q[0][r] + inverse.m[3 + a] * q[1][r]
                         + inverse.m[6 + a] * q[2][r]);
        }
#pragma GCC unroll 9
        for (int r = 0; r < 9; ++r) {
#pragma GCC unroll 9
            for (int c = r; c < 9; ++c) {
                // q of the axis that column c of R belongs to vanishes there.
                const int a = (c / 3 + 1) % 3, b = (c / 3 + 2) % 3;
                S& entry = A[packed(r, c)];
                entry = entry - (w[a][r] * q[a][c] + w[b][r] * q[b][c]);
            }
        }
    }

    /// (tr S I − S)⁻¹ with S = R^T F; its eigenvalues are 1/(σ_i + σ_j).
    template <class S>
    [[gnu::always_inline]] static Matrix3<S> twist_inverse(const Matrix3<S>& F,
                                                           const Matrix3<S>& R) {
        const auto stretch = [&](int i, int j) __attribute__((always_inline)) {
            return R.m[3 * i] * F.m[3 * j] + R.m[3 * i + 1] * F.m[3 * j + 1]
                   + R.m[3 * i + 2] * F.m[3 * j + 2];
        };
        const S xx = stretch(0, 0), yy = stretch(1, 1), zz = stretch(2, 2);
        const S xy = stretch(0, 1), yz = stretch(1, 2), zx = stretch(2, 0);
        const Matrix3<S> G{{yy + zz, -xy, -zx, -xy, zz + xx, -yz, -zx, -yz, xx + yy}};
        Matrix3<S> inverse = cofactor(G);  // of a symmetric matrix: its adjugate
        const S scale = 1.0 / determinant(G, inverse);
        for (S& entry : inverse.m)
            entry = entry * scale;
        return inverse;
    }
};

}  // namespace sim
