// Snow yields to its limits and no further, and remembers the volume.
#include "sim/materials/signed_svd.h"
#include "sim/points/plasticity.h"
#include "tests/support/random_fields.h"

#include <catch2/catch.hpp>

#include <algorithm>

namespace {

sim::Matrix3<double> matrix(const Mat3& F) {
    sim::Matrix3<double> result;
    Eigen::Map<Mat3>(result.m) = F;
    return result;
}

}  // namespace

TEST_CASE("stretches end within the limits, those inside stay, and the volume is kept") {
    const sim::SnowOptions snow;
    const double low = 1 - snow.compression_limit, high = 1 + snow.stretch_limit;
    tests::Random random(4);
    int n_inside = 0;
    for (int k = 0; k < 2000; ++k) {
        const double size = k % 2 ? 0.3 : 0.004;
        const Mat3 F = Mat3::Identity() + size * Mat3::NullaryExpr([&] {
                                              return tests::between(random, -1, 1);
                                          });
        const Vec3 before = sim::signed_svd(F).sigma;
        sim::Matrix3<double> elastic = matrix(F);
        double J_plastic = 0.9;
        sim::yield(snow, elastic, J_plastic);
        const Eigen::Map<const Mat3> after(elastic.m);
        const Vec3 sigma = sim::signed_svd(after).sigma;
        CHECK(sigma.minCoeff() >= low - 1e-14);
        CHECK(sigma.maxCoeff() <= high + 1e-14);
        CHECK((sigma - before.cwiseMax(low).cwiseMin(high)).norm() <= 1e-14);
        CHECK(sigma.prod() * J_plastic == Approx(0.9 * before.prod()).epsilon(1e-13));
        if (before.minCoeff() >= low && before.maxCoeff() <= high) {
            ++n_inside;
            CHECK((after - F).norm() <= 1e-14);
        }
        // The frame of the stretches turns not at all: F_E F⁻¹ is symmetric where F = U σ Vᵀ, F_E = U σ' Vᵀ.
        const Mat3 change = after * F.inverse();
        CHECK((change - change.transpose()).norm() <= 1e-12 * change.norm());
    }
    CHECK(n_inside > 100);
}

TEST_CASE("a point turned inside out comes back with a positive volume") {
    sim::Matrix3<double> F = matrix(Vec3(1.1, 0.9, -0.5).asDiagonal());
    double J_plastic = 1;
    sim::yield({}, F, J_plastic);
    CHECK(sim::determinant(F) > 0);
    CHECK(J_plastic > 0);
    CHECK(J_plastic * sim::determinant(F) == Approx(0.495));
}
