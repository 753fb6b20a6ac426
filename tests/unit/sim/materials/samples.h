// Deformation gradients and conversions that the tests of the materials share.
#pragma once

#include "assets/base/vector_types.h"
#include "sim/materials/law.h"

#include <Eigen/Geometry>

#include <array>
#include <random>
#include <vector>

namespace samples {

inline constexpr std::array all_models = {
    sim::Model::NeoHookean, sim::Model::StableNeoHookean, sim::Model::FixedCorotated};

inline constexpr double young_modulus = 1e6, poisson_ratio = 0.3;
inline constexpr double mu = young_modulus / (2 * (1 + poisson_ratio));
inline constexpr double lambda =
    young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));

using Random = std::mt19937;

inline double between(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

inline Mat3 rotation(Random& random) {
    const auto turn = [&](const Vec3& axis) {
        return Eigen::AngleAxisd(between(random, -3, 3), axis);
    };
    return (turn(Vec3::UnitX()) * turn(Vec3::UnitY()) * turn(Vec3::UnitZ())).toRotationMatrix();
}

inline Mat3 matrix(Random& random) {
    Mat3 A;
    for (double& entry : A.reshaped())
        entry = between(random, -1, 1);
    return A;
}

/// The gradient with these principal stretches, between random rotations.
inline Mat3 stretched(const Vec3& stretches, Random& random) {
    return rotation(random) * stretches.asDiagonal() * rotation(random).transpose();
}

/// Distinct, equal in pairs, all equal, at rest.
inline std::vector<Vec3> stretch_samples() {
    return {{1.7, 1.1, 0.6},
            {0.8, 0.7, 0.5},
            {1.3, 1.3, 0.7},
            {1.4, 0.8, 0.8},
            {0.7, 0.7, 0.7},
            {1.0, 1.0, 1.0},
            {1.5, 1.5, 1.5}};
}

inline sim::Matrix3<double> plain(const Mat3& F) {
    sim::Matrix3<double> result;
    Eigen::Map<Mat3>(result.m) = F;
    return result;
}

inline Mat3 dense(const sim::Matrix3<double>& F) {
    return Eigen::Map<const Mat3>(F.m);
}

inline double energy_density(sim::Model model, const Mat3& F) {
    return sim::visit(model,
                      [&](auto law) { return law.energy_density(plain(F), mu, lambda); });
}

inline Mat3 first_piola(sim::Model model, const Mat3& F) {
    return dense(sim::visit(model, [&](auto law) {
        sim::Matrix3<double> P;
        law.energy_and_first_piola(plain(F), mu, lambda, P);
        return P;
    }));
}

inline Mat9 stiffness(sim::Model model, const Mat3& F) {
    double A[sim::packed_size];
    sim::visit(model, [&](auto law) { law.stiffness(plain(F), mu, lambda, A); });
    Mat9 result;
    for (int r = 0; r < 9; ++r)
        for (int c = 0; c < 9; ++c)
            result(r, c) = A[sim::packed(r, c)];
    return result;
}

}  // namespace samples
