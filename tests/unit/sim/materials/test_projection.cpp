#include "sim/materials/lane_svd.h"
#include "sim/materials/projection.h"
#include "sim/materials/signed_svd.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <catch2/catch.hpp>

#include "samples.h"

using namespace samples;
using sim::Model;

namespace {

using Eigensystem = Eigen::SelfAdjointEigenSolver<Mat9>;

/// The nearest positive semi-definite matrix by way of all nine eigenvectors.
Mat9 clamped(const Mat9& A) {
    const Eigensystem eigen(A);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal()
           * eigen.eigenvectors().transpose();
}

/// Stretched up to threefold, sheared, for some laws inverted.
Mat3 wild_gradient(Model model, Random& random) {
    for (;;) {
        const Mat3 F = 3 * matrix(random);
        if (model != Model::NeoHookean || F.determinant() > 1e-3)
            return F;
    }
}

}  // namespace

TEST_CASE("the projection keeps a definite stiffness") {
    Random random(8);
    for (const Model model : all_models) {
        for (const Vec3& stretches :
             {Vec3(1, 1, 1), Vec3(1.1, 1.1, 1.02), Vec3(1.15, 1.1, 1.05)}) {
            const Mat3 F = stretched(stretches, random);
            const Mat9 A = stiffness(model, F);
            REQUIRE(Eigensystem(A).eigenvalues()[0] > -1e-12 * A.norm());
            CHECK((sim::projected_stiffness(model, F, mu, lambda) - A).norm()
                  < 1e-12 * A.norm());
        }
    }
}

TEST_CASE("the projection clamps the eigenvalues and nothing else") {
    Random random(9);
    int indefinite = 0, inverted = 0;
    for (const Model model : all_models) {
        for (int repeat = 0; repeat < 500; ++repeat) {
            const Mat3 F = wild_gradient(model, random);
            const Mat9 A = stiffness(model, F);
            const Mat9 projected = sim::projected_stiffness(model, F, mu, lambda);
            indefinite += Eigensystem(A).eigenvalues()[0] < -1e-6 * A.norm();
            inverted += F.determinant() < 0;
            CHECK(Eigensystem(projected).eigenvalues()[0] > -1e-13 * projected.norm());
            // A's own rounding grows as the gap of its twists closes: hence its norm, and 1e-11.
            CHECK((projected - clamped(A)).norm() < 1e-11 * A.norm());
        }
    }
    CHECK(indefinite > 500);
    CHECK(inverted > 300);
}

TEST_CASE("the projection is finite at degenerate states") {
    const std::vector<Vec3> degenerate = {
        {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, -1}, {1, 0.5, -0.5}, {2, 1e-12, -1e-12}};
    Random random(10);
    for (const Model model : {Model::StableNeoHookean, Model::FixedCorotated}) {
        for (const Vec3& stretches : degenerate) {
            CAPTURE(int(model), stretches.transpose());
            const Mat9 projected =
                sim::projected_stiffness(model, stretched(stretches, random), mu, lambda);
            REQUIRE(projected.allFinite());
            CHECK(Eigensystem(projected).eigenvalues()[0] > -1e-13 * projected.norm());
            CHECK(projected.norm() < 100 * (mu + lambda));
        }
    }
}

TEST_CASE("the projection refuses what has no stiffness") {
    const Mat3 inverted = Vec3(1, 1, -1).asDiagonal();
    CHECK_THROWS(sim::projected_stiffness(Model::NeoHookean, inverted, mu, lambda));
    const Mat3 unknown = Mat3::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Model model : all_models)
        CHECK_THROWS(sim::projected_stiffness(model, unknown, mu, lambda));
}

TEST_CASE("signed_svd: rotations, ordered stretches, the sign on the smallest") {
    Random random(11);
    std::vector<Mat3> gradients = {
        Mat3::Zero(), Mat3::Identity(), -Mat3::Identity(), Mat3::Ones()};
    for (const Vec3& stretches : stretch_samples())
        gradients.push_back(stretched(stretches, random));
    for (int repeat = 0; repeat < 200; ++repeat)
        gradients.push_back(matrix(random));
    for (const Mat3& F : gradients) {
        const auto [U, sigma, V] = sim::signed_svd(F);
        CHECK((U * sigma.asDiagonal() * V.transpose() - F).norm() <= 1e-14 * F.norm());
        CHECK((U.transpose() * U - Mat3::Identity()).norm() < 1e-14);
        CHECK((V.transpose() * V - Mat3::Identity()).norm() < 1e-14);
        CHECK(U.determinant() > 0);
        CHECK(V.determinant() > 0);
        CHECK(sigma[0] >= sigma[1]);
        CHECK(sigma[1] >= std::abs(sigma[2]));
    }
}

TEST_CASE("orthogonal columns are those of the singular value decomposition") {
    Random random(12);
    std::vector<Mat3> gradients = {Mat3::Zero(),
                                   Mat3::Identity(),
                                   -Mat3::Identity(),
                                   Mat3::Ones(),
                                   Vec3(1, 1e-12, 1e-12).asDiagonal()};
    for (const Vec3& stretches : stretch_samples())
        gradients.push_back(stretched(stretches, random));
    for (const Vec3& stretches : {Vec3(1, 1, 1),
                                  Vec3(2, 1, 1),
                                  Vec3(2, 2, 1),
                                  Vec3(1, 1, -1),
                                  Vec3(3, 1e-6, 0),
                                  Vec3(1 + 1e-9, 1, 1 - 1e-9)})
        gradients.push_back(stretched(stretches, random));
    while (gradients.size() % sim::lane_count != 0 || gradients.size() < 400)
        gradients.push_back(matrix(random));
    for (std::size_t first = 0; first < gradients.size(); first += sim::lane_count) {
        sim::Matrix3<sim::Lanes> F;
        for (int l = 0; l < sim::lane_count; ++l)
            for (int k = 0; k < 9; ++k)
                F.m[k][l] = gradients[first + l](k % 3, k / 3);
        const auto [columns, frame, defect] = sim::orthogonal_columns(F);
        for (int l = 0; l < sim::lane_count; ++l) {
            const Mat3& gradient = gradients[first + l];
            Mat3 B, V;
            for (int k = 0; k < 9; ++k) {
                B(k % 3, k / 3) = columns.m[k][l];
                V(k % 3, k / 3) = frame.m[k][l];
            }
            // Up to 24 rotations, each of which rounds by a few 1e-16.
            CHECK((V.transpose() * V - Mat3::Identity()).norm() <= 1e-14);
            CHECK(V.determinant() == Approx(1));
            CHECK((gradient * V - B).norm() <= 1e-14 * gradient.norm());
            Vec3 sigma = B.colwise().norm();
            std::sort(sigma.data(), sigma.data() + 3, std::greater<>());
            const Eigen::JacobiSVD<Mat3> svd(gradient);
            CHECK((sigma - svd.singularValues()).norm() <= 1e-14 * gradient.norm());
            // The direction of a column that is nothing but rounding is not to be had.
            if (svd.singularValues()[2] > 1e-3 * svd.singularValues()[0])
                CHECK(defect[l] <= 1e-29);
        }
    }
}
