#include "assets/generators/distance_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace assets {

namespace {

/// A value and its derivatives along x, y and z.
using Jet [[gnu::vector_size(32)]] = double;

/// Quadratic B-spline along one axis at offset d in [-1/2, 1/2] from the middle one of three values: their weights in the
/// value, and in the derivatives, of which the one along this axis has others.
std::array<Jet, 3> spline(double d, int axis) {
    const double w[3] = {0.5 * (0.5 - d) * (0.5 - d),
                         0.75 - d * d,
                         0.5 * (0.5 + d) * (0.5 + d)},
                 dw[3] = {d - 0.5, -2 * d, d + 0.5};
    std::array<Jet, 3> weights;
    for (int i = 0; i < 3; ++i) {
        weights[i] = Jet{} + w[i];
        weights[i][1 + axis] = dw[i];
    }
    return weights;
}

}  // namespace

DistanceField::DistanceField(const Solid& solid, double voxel, double margin) : voxel_(voxel) {
    const double border = 2 + std::ceil(margin / voxel);  // cells around the solid's bounds
    low_ = solid.min - Vec3::Constant(border * voxel);
    clearance_ = (border - 1) * voxel;
    for (int axis = 0; axis < 3; ++axis)
        n_[axis] = static_cast<std::size_t>(
            std::ceil((solid.max[axis] - low_[axis]) / voxel + border) + 1);
    values_.resize(n_[0] * n_[1] * n_[2]);
    tbb::parallel_for(std::size_t{0}, n_[1] * n_[2], [&](std::size_t row) {
        for (std::size_t i = 0; i < n_[0]; ++i) {
            const Vec3 x = low_
                           + voxel_
                                 * Vec3(static_cast<double>(i),
                                        static_cast<double>(row % n_[1]),
                                        static_cast<double>(row / n_[1]));
            values_[i + n_[0] * row] = static_cast<float>(solid.signed_distance(x));
        }
    });
}

// Let y be the nearest place to x in the box of the grid, b away. The way from x to the solid enters the box in some z,
// r away from y: |x - z| >= hypot(b, r), as the angle at y is not acute, and from z it is d(y) - r and c, the clearance,
// at least. The sum of both bounds is least where they meet, r = d(y) - c:   d(x) >= c + hypot(b, d(y) - c).
double DistanceField::at(const Vec3& x, Vec3& gradient) const {
    const Vec3 scaled = (x - low_) / voxel_;
    Vec3 nearest;
    for (int axis = 0; axis < 3; ++axis)
        nearest[axis] = std::clamp(scaled[axis], 1.0, static_cast<double>(n_[axis]) - 2);
    const double distance = interpolated(nearest, gradient);
    const double beyond = (scaled - nearest).norm();
    if (!(beyond > 0))
        return distance;
    gradient = (scaled - nearest) / beyond;
    const double clear = std::min(clearance_, distance);
    return clear + std::hypot(voxel_ * beyond, distance - clear);
}

double DistanceField::interpolated(const Vec3& scaled, Vec3& gradient) const {
    std::size_t lowest[3];
    std::array<Jet, 3> weights[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double middle = std::floor(scaled[axis] + 0.5);
        lowest[axis] = static_cast<std::size_t>(middle) - 1;
        weights[axis] = spline(scaled[axis] - middle, axis);
    }
    const auto& [wx, wy, wz] = weights;
    Jet sum{};
    for (int k = 0; k < 3; ++k) {
        Jet plane{};
        for (int j = 0; j < 3; ++j) {
            const float* row =
                &values_[lowest[0] + n_[0] * (lowest[1] + j + n_[1] * (lowest[2] + k))];
            plane += wy[j] * (row[0] * wx[0] + row[1] * wx[1] + row[2] * wx[2]);
        }
        sum += wz[k] * plane;
    }
    gradient = Vec3(sum[1], sum[2], sum[3]) / voxel_;
    return sum[0];
}

}  // namespace assets
