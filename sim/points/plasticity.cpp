#include "sim/points/plasticity.h"

#include "sim/materials/polar.h"
#include "sim/materials/signed_svd.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

/// Whether |FᵀF - 1| leaves no stretch outside [low, high].
bool is_surely_inside(const Matrix3<double>& F, double low, double high) {
    Matrix3<double> E = gram(F);
    for (int k = 0; k < 9; k += 4)
        E.m[k] -= 1;
    const double most = std::sqrt(inner(E, E));
    return 1 - most >= low * low && 1 + most <= high * high && determinant(F) > 0;
}

}  // namespace

void yield(const SnowOptions& snow, Matrix3<double>& F, double& J_plastic) {
    const double low = 1 - snow.compression_limit, high = 1 + snow.stretch_limit;
    if (is_surely_inside(F, low, high))
        return;
    Eigen::Map<Mat3> f(F.m);
    const auto [U, sigma, V] = signed_svd(f);
    const Vec3 elastic = sigma.cwiseMax(low).cwiseMin(high);
    f = U * elastic.asDiagonal() * V.transpose();
    J_plastic *= std::abs(sigma.prod()) / elastic.prod();
}

}  // namespace sim
