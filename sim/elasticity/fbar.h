// One domain with eight Gauss points and F-bar: energy, forces and stiffness.
#pragma once

#include "sim/materials/lanes.h"
#include "sim/scene.h"

#include <array>

namespace sim {

/// ∂N_a/∂X_j [1/m] of a cube of edge s, at its centre and at the Gauss points; point g lies at (g & 1, g >> 1 & 1, g >> 2)
/// of the 2×2×2. Once with the points side by side and once with the corners.
struct CubeGradients {
    explicit CubeGradients(double s);

    double at_centre[3][8];     // [j][a]
    double at_points[8][3][8];  // [a][j][g]
    double of_point[8][3][8];   // [g][j][a]
};

/// The material of a domain.
struct FbarDomain {
    Model model = Model::NeoHookean;
    double volume = 0;          // filled [m³]
    double mu = 0, lambda = 0;  // [Pa]
};

/// Values at a domain's corners: component i of corner a at 8 i + a.
using CornerValues = std::array<double, 24>;

/// E = V/8 Σ_g Ψ(F̄_g),  F̄_g = F_g (J_c/J_g)^⅓  with c the centre, and its gradient ∂E/∂x [N]. +infinity, and no gradient,
/// where J is not positive at a Gauss point or at the centre. [J]
///
/// With P̄ = ∂Ψ/∂F̄, r = (J_c/J_g)^⅓ and p = P̄ : F̄ / 3 the gradient is V/8 Σ_g [(r P̄ - p F_g^-T) b_g + p F_c^-T b_c].
double fbar_gradient(const CubeGradients& b,
                     const FbarDomain& domain,
                     const CornerValues& x,
                     CornerValues& gradient);

/// ∂²E/∂x² (24×24), exact: with D = r (B_g + ⅓ F_g t^T), t = F_c^-T b_c - F_g^-T b_g the derivative of ln(J_c/J_g), and
/// s = r P̄ b_g,
///
///   K = V/8 Σ_g [Dᵀ A D + ⅓ (t sᵀ + s tᵀ) + p/3 t tᵀ + p (G_g - G_c)],  G(u,u) = tr(F⁻¹ ∂u/∂X F⁻¹ ∂u/∂X).
///
/// `stiffness` (24×24) [N/m]. Requires a state that fbar_gradient() allows.
void fbar_stiffness(const CubeGradients& b,
                    const FbarDomain& domain,
                    const CornerValues& x,
                    float* stiffness);

/// rho c² of the fastest wave at the centre, from above.   [Pa]
double fbar_wave_modulus(const CubeGradients& b,
                         const FbarDomain& domain,
                         const CornerValues& x);

/// The smallest det F at the Gauss points and the centre.
double fbar_smallest_J(const CubeGradients& b, const CornerValues& x);

/// out = K u.
void fbar_product(const float* stiffness, const CornerValues& u, CornerValues& out);

}  // namespace sim
