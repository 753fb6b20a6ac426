#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "samples.h"
#include <algorithm>

using namespace samples;

namespace {

// A wrong derivative leaves an error that does not shrink with the step; a right one shrinks as h².
// So the tests ask for the observed order, not for closeness at one lucky step.
template <class Error>
double observed_order(const Error& error) {
    return std::log10(error(3e-3) / error(3e-4));
}

void check_first_piola(sim::Model model, const Mat3& F, Random& random) {
    const Mat3 direction = matrix(random), P = first_piola(model, F);
    const auto error = [&](double h) {
        const double difference =
            energy_density(model, F + h * direction) - energy_density(model, F - h * direction);
        return std::abs(difference / (2 * h) - P.cwiseProduct(direction).sum());
    };
    CHECK(observed_order(error) == Approx(2.0).margin(0.05));
}

void check_stiffness(sim::Model model, const Mat3& F, Random& random) {
    const Mat3 direction = matrix(random);
    const Vec9 exact = stiffness(model, F) * vec(direction);
    REQUIRE(exact.norm() > 1e-3 * mu);  // else the test could pass vacuously
    const auto error = [&](double h) {
        const Mat3 difference =
            first_piola(model, F + h * direction) - first_piola(model, F - h * direction);
        return (vec(difference) / (2 * h) - exact).norm();
    };
    CHECK(observed_order(error) == Approx(2.0).margin(0.05));
}

}  // namespace

TEST_CASE("P is the derivative of the energy density, and A of P") {
    Random random(1);
    for (const sim::Model model : all_models) {
        for (const Vec3& stretches : stretch_samples()) {
            CAPTURE(int(model), stretches.transpose());
            const Mat3 F = stretched(stretches, random);
            check_first_piola(model, F, random);
            for (int repeat = 0; repeat < 9; ++repeat)  // as many directions as F has entries
                check_stiffness(model, F, random);
        }
    }
}

TEST_CASE("no wave is faster than the highest wave modulus says, and one is as fast") {
    // a⊗b : A : a⊗b over unit vectors, by the eigenvalue of what is left with b fixed.
    Random random(3);
    for (const sim::Model model : all_models)
        for (const Vec3& stretches : stretch_samples()) {
            CAPTURE(int(model), stretches.transpose());
            const Mat3 F = stretched(stretches, random);
            const Mat9 A = stiffness(model, F);
            const double bound = sim::visit(model, [&](auto law) {
                return law.highest_wave_modulus(plain(F), mu, lambda);
            });
            double most = 0;
            for (int k = 0; k < 20000; ++k) {
                const Vec3 b = rotation(random).col(0);
                Mat3 acoustic = Mat3::Zero();
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        acoustic += b[i] * b[j] * A.block<3, 3>(3 * i, 3 * j);
                most = std::max(
                    most,
                    Eigen::SelfAdjointEigenSolver<Mat3>(acoustic).eigenvalues().maxCoeff());
            }
            CHECK(most <= bound * (1 + 1e-12));
            // Of the cofactor's stretches: where the smaller two are equal the bound is exact.
            Vec3 c(stretches[1] * stretches[2],
                   stretches[2] * stretches[0],
                   stretches[0] * stretches[1]);
            std::sort(c.begin(), c.end());
            if (model != sim::Model::FixedCorotated && c[0] == c[1])
                CHECK(most > 0.99 * bound);
            CHECK(most > 0.6 * bound);
        }
}

TEST_CASE("the derivatives hold for inverted elements where the law is finite") {
    Random random(2);
    for (const sim::Model model : {sim::Model::StableNeoHookean, sim::Model::FixedCorotated}) {
        for (const Vec3& stretches : {Vec3(1.2, 0.9, -0.3), Vec3(1.1, 1.1, -0.4)}) {
            CAPTURE(int(model), stretches.transpose());
            const Mat3 F = stretched(stretches, random);
            check_first_piola(model, F, random);
            for (int repeat = 0; repeat < 9; ++repeat)
                check_stiffness(model, F, random);
        }
    }
}

TEST_CASE("the stiffness at rest is Hooke's law") {
    Mat9 hooke = Mat9::Zero();  // dP = μ (dF + dF^T) + λ tr(dF) I
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            hooke(3 * j + i, 3 * j + i) += mu;
            hooke(3 * j + i, 3 * i + j) += mu;
            hooke(4 * i, 4 * j) += lambda;
        }
    }
    for (const sim::Model model : all_models) {
        const Mat9 A = stiffness(model, Mat3::Identity());
        CHECK((A - hooke).norm() < 1e-14 * hooke.norm());  // some dozen roundings
    }
}
