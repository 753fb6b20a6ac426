// Snow yields to its limits and no further, and remembers the volume.
#include "sim/materials/signed_svd.h"
#include "sim/points/plasticity.h"
#include "tests/support/random_fields.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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
        const Mat3 F_n = Mat3::Identity() + 0.1 * Mat3::NullaryExpr([&] {
                                                return tests::between(random, -1, 1);
                                            });
        sim::Matrix3<double> start = matrix(F_n);
        sim::yield(snow, elastic, start, J_plastic);
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
        // What led from F_n to F leads from F_n Y to F Y.
        const Mat3 motion = F * F_n.inverse();
        CHECK((motion * Eigen::Map<const Mat3>(start.m) - after).norm()
              <= 1e-12 * motion.norm());
    }
    CHECK(n_inside > 100);
}

TEST_CASE("a flat point becomes a thin one, and what is no number stays") {
    const sim::SnowOptions snow;
    sim::Matrix3<double> F = matrix(Vec3(1, 1, 0).asDiagonal()), F_n = matrix(Mat3::Identity());
    double J_plastic = 1;
    sim::yield(snow, F, F_n, J_plastic);
    CHECK(F.m[8] == Approx(1 - snow.compression_limit));
    CHECK(Eigen::Map<const Mat3>(F_n.m).allFinite());

    F = matrix(Mat3::Identity());
    F.m[4] = std::numeric_limits<double>::quiet_NaN();
    const sim::Matrix3<double> before = F_n;
    sim::yield(snow, F, F_n, J_plastic);
    CHECK(std::isnan(F.m[4]));
    CHECK(F.m[0] == 1);
    CHECK(std::equal(before.m, before.m + 9, F_n.m));
    CHECK(std::isfinite(J_plastic));
}

TEST_CASE("a point turned inside out comes back with a positive volume") {
    sim::Matrix3<double> F = matrix(Vec3(1.1, 0.9, -0.5).asDiagonal()), F_n = F;
    double J_plastic = 1;
    sim::yield({}, F, F_n, J_plastic);
    CHECK(sim::determinant(F) > 0);
    CHECK(J_plastic > 0);
    CHECK(J_plastic * sim::determinant(F) == Approx(0.495));
}

TEST_CASE("points yield side by side as each of them alone") {
    // Two kinds of snow and one of rubber, in any order and number; some turned inside out, flat or without size.
    sim::MaterialPoints points;
    points.model = {sim::Model::Snow, sim::Model::NeoHookean, sim::Model::Snow};
    points.snow.resize(3);
    points.snow[2].compression_limit = 0.1;
    points.snow[2].stretch_limit = 0.05;
    tests::Random random(5);
    const int n = 1003;
    for (int p = 0; p < n; ++p)
        points.region.push_back(static_cast<int>(tests::between(random, 0, 3)));
    points.rest.resize(n);
    sim::PointState together(n);
    for (int p = 0; p < n; ++p) {
        const double size = p % 3 == 0 ? 1 : p % 3 == 1 ? 0.05 : 0.002;
        together.F[p] = matrix(Mat3::Identity() + size * Mat3::NullaryExpr([&] {
                                                      return tests::between(random, -1, 1);
                                                  }));
        if (p % 50 == 0)
            together.F[p] = matrix(Vec3(1, 1.2, p % 100 ? 0 : -1).asDiagonal());
        if (p % 75 == 0)
            together.F[p] = matrix(Mat3::Zero());
        together.J_plastic[p] = tests::between(random, 0.8, 1.2);
    }
    const sim::PointState before = together;
    sim::PointState alone = together, together_n(n), alone_n(n);
    std::vector<int> yielding(n - 2);
    std::iota(yielding.rbegin(), yielding.rend(), 2);
    sim::yield(points,
               yielding.data(),
               n - 2,
               together.F.data(),
               together_n.F.data(),
               together.J_plastic.data());
    int n_yielded = 0;
    for (int p = 2; p < n; ++p) {
        if (points.is_snow(p))
            sim::yield(
                points.snow[points.region[p]], alone.F[p], alone_n.F[p], alone.J_plastic[p]);
        const Eigen::Map<const Mat3> is(together.F[p].m), wanted(alone.F[p].m),
            was(before.F[p].m);
        // The nearer two stretches come to cancel, the less is sure about the frame in between.
        const Vec3 sigma = sim::signed_svd(was).sigma;
        const double gap = std::max(sigma[1] + sigma[2], 1e-3);
        CHECK((is - wanted).norm() <= 1e-13 / gap);
        const Eigen::Map<const Mat3> is_n(together_n.F[p].m), wanted_n(alone_n.F[p].m);
        if (sigma.cwiseAbs().minCoeff() > 0.1)
            CHECK((is_n - wanted_n).norm() <= 1e-12 / gap);
        CHECK(together.J_plastic[p] == Approx(alone.J_plastic[p]).epsilon(1e-13).margin(1e-15));
        if (!points.is_snow(p))
            CHECK(is == was);
        n_yielded += is != was;
    }
    CHECK(n_yielded > 300);
    for (int p = 0; p < 2; ++p)
        CHECK(together.J_plastic[p] == before.J_plastic[p]);
}
