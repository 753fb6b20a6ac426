#include "sim/materials/projection.h"

#include "assets/base/error.h"
#include "sim/materials/lanes.h"
#include "sim/materials/signed_svd.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

/// A law at one state, as Ψ = Σ f(σ_i) + h(J) with f'' constant, so f' = f''σ + const.
struct PrincipalLaw {
    double d2f;         // f'' [Pa]
    double df_at_zero;  // f'(0) [Pa]
    double dh;          // h' [Pa]
    double ddh;         // h'' [Pa]
};

PrincipalLaw principal_law(Model model, double J, double mu, double lambda) {
    switch (model) {
        case Model::NeoHookean: {
            assets::check(J > 0, "projected_stiffness: J > 0 for the neo-Hookean law");
            const double J_log = log_of(J);
            return {mu, 0, (lambda * J_log - mu) / J, (lambda + mu - lambda * J_log) / (J * J)};
        }
        case Model::StableNeoHookean:
            return {mu, 0, (lambda + mu) * (J - 1) - mu, lambda + mu};
        case Model::FixedCorotated:
        case Model::Snow:
            return {2 * mu, -2 * mu, lambda * (J - 1), lambda};
    }
    assets::check(false, "projected_stiffness: the model is known");
    return {};
}

/// The Hessian of Ψ in the principal stretches, without its negative eigenvalues.
Mat3 projected_stretch_hessian(const PrincipalLaw& law, const Vec3& sigma) {
    const Vec3 areas(sigma[1] * sigma[2], sigma[2] * sigma[0], sigma[0] * sigma[1]);
    Mat3 H = law.ddh * areas * areas.transpose();
    for (int i = 0; i < 3; ++i) {
        H(i, i) += law.d2f;
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        H(i, j) += sigma[k] * law.dh;
        H(j, i) = H(i, j);
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(H);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal()
           * eigen.eigenvectors().transpose();
}

}  // namespace

Mat9 projected_stiffness(Model model, const Mat3& F, double mu, double lambda) {
    const auto [U, sigma, V] = signed_svd(F);
    const PrincipalLaw law = principal_law(model, sigma.prod(), mu, lambda);

    // Columns: u_i v_i^T, then for each pair of axes its twist and its flip; all orthonormal.
    Mat9 modes;
    Mat9 eigenvalues = Mat9::Zero();
    eigenvalues.topLeftCorner<3, 3>() = projected_stretch_hessian(law, sigma);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const Mat3 a = U.col(i) * V.col(j).transpose(), b = U.col(j) * V.col(i).transpose();
        modes.col(k) = vec(U.col(k) * V.col(k).transpose());
        modes.col(3 + k) = vec(a - b) * std::sqrt(0.5);
        modes.col(6 + k) = vec(a + b) * std::sqrt(0.5);

        // The floor keeps 0/0 out; the twist that it alters is clamped to zero in any case.
        const double pair = std::max(sigma[i] + sigma[j], 1e-6);
        const double twist = law.d2f + 2 * law.df_at_zero / pair + sigma[k] * law.dh;
        const double flip = law.d2f - sigma[k] * law.dh;
        eigenvalues(3 + k, 3 + k) = std::max(twist, 0.0);
        eigenvalues(6 + k, 6 + k) = std::max(flip, 0.0);
    }
    return modes * eigenvalues * modes.transpose();
}

}  // namespace sim
