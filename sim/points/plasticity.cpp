#include "sim/points/plasticity.h"

#include "sim/base/lane_clones.h"
#include "sim/materials/lane_svd.h"
#include "sim/materials/polar.h"
#include "sim/materials/signed_svd.h"
#include "sim/points/lane_rows.h"
#include "sim/points/stretch_limits.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr double least_stretch = 0.1;  // that is far enough from zero to divide by
constexpr double flat = 1e-9;  // stretch that is divided by in its place where there is none
constexpr double most_defect = 1e-28;  // squared cosine of an angle between singular vectors

/// Points that yield side by side, and what their stretches are brought into.
struct YieldingBatch {
    Matrix3<Lanes> F;
    alignas(64) Lanes low{}, high{};
};

/// F and F_n with the stretches of F inside, the volume that they have lost, and whether that can be trusted: where it is
/// positive.
struct Yielded {
    Matrix3<Lanes> F, F_n;
    alignas(64) Lanes volume, trust;
};

[[gnu::always_inline]] inline Yielded yielded(const YieldingBatch& batch,
                                              const Matrix3<Lanes>& F_n) {
    const auto [B, V, defect] = orthogonal_columns(batch.F);
    const Matrix3<Lanes> B_n = product(F_n, V);
    Yielded result{
        batch.F, F_n, uniform<Lanes>(1), smaller(determinant(batch.F), most_defect - defect)};
    for (int k = 0; k < 3; ++k) {
        const Lanes sigma = sqrt_of(column_dot(B, k, k));
        const Lanes kept =
            smaller(select_positive(Lanes(sigma - batch.low), sigma, batch.low), batch.high);
        const Lanes change = kept / sigma - 1;
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const Lanes share = change * V.m[3 * k + j];
                result.F.m[3 * j + i] += share * B.m[3 * k + i];
                result.F_n.m[3 * j + i] += share * B_n.m[3 * k + i];
            }
        result.volume *= sigma / kept;
        result.trust = smaller(result.trust, sigma - least_stretch);
    }
    return result;
}

}  // namespace

void yield(const SnowOptions& snow,
           Matrix3<double>& F,
           Matrix3<double>& F_n,
           double& J_plastic) {
    const double low = 1 - snow.compression_limit, high = 1 + snow.stretch_limit;
    if (inside(F, low, high) > 0)
        return;
    Eigen::Map<Mat3> f(F.m), f_n(F_n.m);
    if (!f.allFinite())
        return;
    auto [U, sigma, V] = signed_svd(f);
    for (double& stretch : sigma)
        if (std::abs(stretch) < flat)
            stretch = std::copysign(flat, stretch);
    const Vec3 elastic = sigma.cwiseMax(low).cwiseMin(high);
    f = U * elastic.asDiagonal() * V.transpose();
    f_n = f_n * V * elastic.cwiseQuotient(sigma).asDiagonal() * V.transpose();
    J_plastic *= std::abs(sigma.prod()) / elastic.prod();
}

SUPPLE_LANES
bool yield(const MaterialPoints& points,
           const int* yielding,
           int n,
           Matrix3<double>* F,
           Matrix3<double>* F_n,
           double* J_plastic) {
    static const Matrix3<double> rest{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    YieldingBatch batch{};
    bool any = false;
    for (int first = 0; first < n; first += lane_count) {
        int point[lane_count];
        const Matrix3<double>*trial[lane_count], *start[lane_count];
        for (int l = 0; l < lane_count; ++l) {
            const int p = point[l] = yielding[std::min(first + l, n - 1)];
            const SnowOptions& snow = points.snow[points.region[p]];
            trial[l] = first + l < n && points.is_snow(p) ? &F[p] : &rest;
            start[l] = &F_n[p];
            batch.low[l] = 1 - snow.compression_limit;
            batch.high[l] = 1 + snow.stretch_limit;
        }
        batch.F = load_lanes(trial);
        const Lanes stays = inside(batch.F, batch.low, batch.high);
        bool all_inside = true;
        for (int l = 0; l < lane_count; ++l)
            all_inside = all_inside && (trial[l] == &rest || stays[l] > 0);
        if (all_inside)
            continue;
        any = true;
        const Yielded result = yielded(batch, load_lanes(start));
        Matrix3<double> F_end[lane_count], F_n_end[lane_count], *to[lane_count],
            *to_n[lane_count];
        for (int l = 0; l < lane_count; ++l) {
            to[l] = &F_end[l];
            to_n[l] = &F_n_end[l];
        }
        store_lanes(result.F, to);
        store_lanes(result.F_n, to_n);
        for (int l = 0; l < lane_count; ++l) {
            const int p = point[l];
            if (trial[l] == &rest || stays[l] > 0)
                continue;
            if (result.trust[l] > 0) {
                F[p] = F_end[l];
                F_n[p] = F_n_end[l];
                J_plastic[p] *= result.volume[l];
            } else {
                yield(points.snow[points.region[p]], F[p], F_n[p], J_plastic[p]);
            }
        }
    }
    return any;
}

}  // namespace sim
