#include "sim/points/plasticity.h"

#include "sim/materials/lane_svd.h"
#include "sim/materials/polar.h"
#include "sim/materials/signed_svd.h"
#include "sim/points/lane_rows.h"

#include <algorithm>
#include <cmath>

// Compiled for two instruction sets and chosen at run time; both do the same operations in every lane.
#define SUPPLE_LANES __attribute__((target_clones("arch=x86-64-v4", "default")))

namespace sim {

namespace {

constexpr double least_stretch = 0.1;  // that is far enough from zero to divide by
constexpr double most_defect = 1e-28;  // squared cosine of an angle between singular vectors

template <class S>
[[gnu::always_inline]] inline S smaller(const S& a, const S& b) {
    return select_positive(S(b - a), a, b);
}

/// Positive where the symmetric A has positive eigenvalues alone: the first pivot of its LDLᵀ that is not positive, else
/// the last. Elimination without exchanges is stable there: it is wrong by no more than the rounding of A.
template <class S>
[[gnu::always_inline]] inline S positive_definite(const Matrix3<S>& A) {
    const S first = A.m[0], x = A.m[1] / first, y = A.m[2] / first;
    const S second = A.m[4] - x * A.m[1], yz = A.m[5] - x * A.m[2];
    const S third = A.m[8] - y * A.m[2] - yz * yz / second;
    return select_positive(first, select_positive(second, third, second), first);
}

/// Positive where no stretch of F is outside of [low, high] and F keeps its side: low² 1 < FᵀF < high² 1.
template <class S>
[[gnu::always_inline]] inline S inside(const Matrix3<S>& F, const S& low, const S& high) {
    Matrix3<S> above = gram(F), below;
    for (int k = 0; k < 9; ++k)
        below.m[k] = -above.m[k];
    for (int k = 0; k < 9; k += 4) {
        above.m[k] -= low * low;
        below.m[k] += high * high;
    }
    return smaller(smaller(positive_definite(above), positive_definite(below)), determinant(F));
}

/// Points that yield side by side, and what their stretches are brought into.
struct YieldingBatch {
    Matrix3<Lanes> F;
    alignas(64) Lanes low{}, high{};
};

/// F with its stretches inside, the volume that it has lost, and whether that can be trusted: where it is positive.
struct Yielded {
    Matrix3<Lanes> F;
    alignas(64) Lanes volume, trust;
};

[[gnu::always_inline]] inline Yielded yielded(const YieldingBatch& batch) {
    const auto [B, V, defect] = orthogonal_columns(batch.F);
    Yielded result{
        batch.F, uniform<Lanes>(1), smaller(determinant(batch.F), most_defect - defect)};
    for (int k = 0; k < 3; ++k) {
        const Lanes sigma = sqrt_of(column_dot(B, k, k));
        const Lanes kept =
            smaller(select_positive(Lanes(sigma - batch.low), sigma, batch.low), batch.high);
        const Lanes change = kept / sigma - 1;
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
                result.F.m[3 * j + i] += change * B.m[3 * k + i] * V.m[3 * k + j];
        result.volume *= sigma / kept;
        result.trust = smaller(result.trust, sigma - least_stretch);
    }
    return result;
}

}  // namespace

void yield(const SnowOptions& snow, Matrix3<double>& F, double& J_plastic) {
    const double low = 1 - snow.compression_limit, high = 1 + snow.stretch_limit;
    if (inside(F, low, high) > 0)
        return;
    Eigen::Map<Mat3> f(F.m);
    const auto [U, sigma, V] = signed_svd(f);
    const Vec3 elastic = sigma.cwiseMax(low).cwiseMin(high);
    f = U * elastic.asDiagonal() * V.transpose();
    J_plastic *= std::abs(sigma.prod()) / elastic.prod();
}

SUPPLE_LANES
void yield(const MaterialPoints& points, int begin, int end, PointState& state) {
    static const Matrix3<double> rest{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    YieldingBatch batch{};
    for (int first = begin; first < end; first += lane_count) {
        const Matrix3<double>* F[lane_count];
        for (int l = 0; l < lane_count; ++l) {
            const int p = first + l;
            const bool is_snow = p < end && points.is_snow(p);
            const SnowOptions& snow = points.snow[points.region[std::min(p, end - 1)]];
            F[l] = is_snow ? &state.F[p] : &rest;
            batch.low[l] = 1 - snow.compression_limit;
            batch.high[l] = 1 + snow.stretch_limit;
        }
        batch.F = load_lanes(F);
        const Lanes stays = inside(batch.F, batch.low, batch.high);
        bool all_inside = true;
        for (int l = 0; l < lane_count; ++l)
            all_inside = all_inside && (F[l] == &rest || stays[l] > 0);
        if (all_inside)
            continue;
        const Yielded end_state = yielded(batch);
        Matrix3<double> F_end[lane_count], *to[lane_count];
        for (int l = 0; l < lane_count; ++l)
            to[l] = &F_end[l];
        store_lanes(end_state.F, to);
        for (int l = 0; l < lane_count; ++l) {
            const int p = first + l;
            if (F[l] == &rest || stays[l] > 0)
                continue;
            if (end_state.trust[l] > 0) {
                state.F[p] = F_end[l];
                state.J_plastic[p] *= end_state.volume[l];
            } else {
                yield(points.snow[points.region[p]], state.F[p], state.J_plastic[p]);
            }
        }
    }
}

}  // namespace sim
