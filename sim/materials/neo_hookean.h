// Compressible neo-Hookean law with logarithmic volume energy: it resists collapse without bound.
#pragma once

#include "sim/materials/packed_stiffness.h"
#include "sim/materials/wave_modulus.h"

namespace sim {

/// Ψ(F) = μ/2 (‖F‖² − 3) − μ ln J + λ/2 ln²J.   S is double or Lanes; μ and λ are Lamé's [Pa].
/// At J <= 0 (also below the smallest normal number) Ψ is +infinity and has no derivatives: those
/// are NaN. A line search that asks Ψ first never meets them.
struct NeoHookean {
    /// Ψ [J/m³].
    template <class S>
    [[gnu::always_inline]] static S energy_density(const Matrix3<S>& F, S mu, S lambda) {
        return energy_density(F, volume(F, cofactor(F)), mu, lambda);
    }

    /// Ψ [J/m³] and, for the work of one, P = ∂Ψ/∂F = μF + h'(J) ∂J/∂F,  h' = (λ ln J − μ)/J [Pa].
    template <class S>
    [[gnu::always_inline]] static S energy_and_first_piola(const Matrix3<S>& F,
                                                           S mu,
                                                           S lambda,
                                                           Matrix3<S>& P) {
        const Matrix3<S> C = cofactor(F);
        const Volume<S> v = volume(F, C);
        const S dh = (lambda * v.log - mu) * v.inverse;
        for (int n = 0; n < 9; ++n)
            P.m[n] = mu * F.m[n] + dh * C.m[n];
        return energy_density(F, v, mu, lambda);
    }

    /// ∂P/∂F, packed; h'' = (λ + μ − λ ln J)/J².   [Pa]
    template <class S>
    [[gnu::always_inline]] static void stiffness(const Matrix3<S>& F, S mu, S lambda, S* A) {
        const Matrix3<S> C = cofactor(F);
        const Volume<S> v = volume(F, C);
        const S dh = (lambda * v.log - mu) * v.inverse;
        set_stiffness(F, C, mu, dh, second_derivative(v, mu, lambda), A);
    }

    /// rho c² of the fastest wave, from above.   [Pa]
    template <class S>
    [[gnu::always_inline]] static S highest_wave_modulus(const Matrix3<S>& F, S mu, S lambda) {
        const Matrix3<S> C = cofactor(F);
        return wave_modulus(C, mu, second_derivative(volume(F, C), mu, lambda));
    }

  private:
    template <class S>
    struct Volume {
        S log, inverse;  // 0 and NaN at J <= 0
        S barrier;       // 0, +infinity at J <= 0
    };

    template <class S>
    [[gnu::always_inline]] static Volume<S> volume(const Matrix3<S>& F, const Matrix3<S>& C) {
        using Limits = std::numeric_limits<double>;
        const S J = determinant(F, C);
        const S valid = J - Limits::min();
        const S J_safe = select_positive(valid, J, uniform<S>(1));
        return {log_of(J_safe),
                select_positive(valid, 1.0 / J_safe, uniform<S>(Limits::quiet_NaN())),
                select_positive(valid, uniform<S>(0), uniform<S>(Limits::infinity()))};
    }

    /// h''(J).
    template <class S>
    [[gnu::always_inline]] static S second_derivative(const Volume<S>& v, S mu, S lambda) {
        return (lambda + mu - lambda * v.log) * v.inverse * v.inverse;
    }

    template <class S>
    [[gnu::always_inline]] static S energy_density(const Matrix3<S>& F,
                                                   const Volume<S>& v,
                                                   S mu,
                                                   S lambda) {
        return mu * (0.5 * (inner(F, F) - 3.0) - v.log) + 0.5 * lambda * v.log * v.log
               + v.barrier;
    }
};

}  // namespace sim
