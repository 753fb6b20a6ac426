// The stiffness made positive semi-definite, for solvers that need a direction of descent.
#pragma once

#include "assets/base/vector_types.h"
#include "sim/scene.h"

namespace sim {

/// ∂P/∂F (9×9, vec order) [Pa] with its negative eigenvalues set to zero: the nearest positive
/// semi-definite matrix in the Frobenius norm.
///
/// In the frame of the principal stretches σ the nine eigenmodes fall into closed form [SGK18 §4]:
/// three that scale the stretches (the 3×3 Hessian of Ψ in σ), three that twist and three that flip
/// a pair of axes. Where two stretches sum to zero, the twist of the fixed corotated law is infinitely
/// unstable: it is zero here.
/// Requires finite F, and J > 0 for Model::NeoHookean, else throws std::logic_error.
Mat9 projected_stiffness(Model model, const Mat3& F, double mu, double lambda);

}  // namespace sim
