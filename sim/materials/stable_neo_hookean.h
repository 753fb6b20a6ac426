// Stable neo-Hookean law without the logarithm: finite, with finite stress, for inverted elements too.
#pragma once

#include "sim/materials/packed_stiffness.h"
#include "sim/materials/wave_modulus.h"

namespace sim {

/// Ψ(F) = μ/2 (‖F‖² − 3) − μ (J − 1) + (λ + μ)/2 (J − 1)², which is
/// μ/2 (‖F‖² − 3) + (λ + μ)/2 (J − 1 − μ/(λ + μ))² less its value at rest.   [SGK18 §3.4]
/// S is double or Lanes; μ and λ are Lamé's constants of small strains [Pa]: the λ of the source is
/// our λ + μ.
struct StableNeoHookean {
    /// Ψ [J/m³].
    template <class S>
    [[gnu::always_inline]] static S energy_density(const Matrix3<S>& F, S mu, S lambda) {
        return energy_density(F, determinant(F) - 1.0, mu, lambda);
    }

    /// Ψ [J/m³] and, for the work of one, P = ∂Ψ/∂F = μF + h'(J) ∂J/∂F,  h' = (λ + μ)(J − 1) − μ [Pa].
    template <class S>
    [[gnu::always_inline]] static S energy_and_first_piola(const Matrix3<S>& F,
                                                           S mu,
                                                           S lambda,
                                                           Matrix3<S>& P) {
        const Matrix3<S> C = cofactor(F);
        const S growth = determinant(F, C) - 1.0;
        const S dh = (lambda + mu) * growth - mu;
        for (int n = 0; n < 9; ++n)
            P.m[n] = mu * F.m[n] + dh * C.m[n];
        return energy_density(F, growth, mu, lambda);
    }

    /// ∂P/∂F, packed; h'' = λ + μ.   [Pa]
    template <class S>
    [[gnu::always_inline]] static void stiffness(const Matrix3<S>& F, S mu, S lambda, S* A) {
        const Matrix3<S> C = cofactor(F);
        const S dh = (lambda + mu) * (determinant(F, C) - 1.0) - mu;
        set_stiffness(F, C, mu, dh, lambda + mu, A);
    }

    /// rho c² of the fastest wave, from above.   [Pa]
    template <class S>
    [[gnu::always_inline]] static S highest_wave_modulus(const Matrix3<S>& F, S mu, S lambda) {
        return wave_modulus(cofactor(F), mu, S(lambda + mu));
    }

  private:
    template <class S>
    [[gnu::always_inline]] static S energy_density(const Matrix3<S>& F,
                                                   S growth,
                                                   S mu,
                                                   S lambda) {
        return mu * (0.5 * (inner(F, F) - 3.0) - growth)
               + 0.5 * (lambda + mu) * growth * growth;
    }
};

}  // namespace sim
