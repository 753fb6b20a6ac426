#include "assets/generators/distance_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace assets {

namespace {

/// Quadratic B-spline at offset d in [-1/2, 1/2] from the middle one of three values: weights, and their derivatives.
struct Spline {
    explicit Spline(double d)
        : w{0.5 * (0.5 - d) * (0.5 - d), 0.75 - d * d, 0.5 * (0.5 + d) * (0.5 + d)},
          dw{d - 0.5, -2 * d, d + 0.5} {}

    double w[3], dw[3];
};

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
    int middle[3];
    for (int axis = 0; axis < 3; ++axis)
        middle[axis] = static_cast<int>(std::floor(scaled[axis] + 0.5));
    const Spline a(scaled[0] - middle[0]), b(scaled[1] - middle[1]), c(scaled[2] - middle[2]);
    double distance = 0;
    gradient = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const double f = value(middle[0] + i - 1, middle[1] + j - 1, middle[2] + k - 1);
                distance += f * (a.w[i] * b.w[j] * c.w[k]);
                gradient += f
                            * Vec3(a.dw[i] * b.w[j] * c.w[k],
                                   a.w[i] * b.dw[j] * c.w[k],
                                   a.w[i] * b.w[j] * c.dw[k]);
            }
    gradient /= voxel_;
    return distance;
}

}  // namespace assets
