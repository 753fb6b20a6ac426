#include "sim/points/point_laws.h"

#include "sim/base/lane_clones.h"
#include "sim/materials/law.h"
#include "sim/materials/projection.h"
#include "sim/points/lane_rows.h"

#include <algorithm>
#include <cstring>

namespace sim {

namespace {

#define ALWAYS_INLINE [[gnu::always_inline]] inline

struct Batch {
    alignas(64) Lanes volume, mu, lambda, model;
    unsigned models;  // bit m set where a point of the body has model m
    int n;            // points; the lanes above have no volume and rest undeformed
};

/// Where the points of a batch are; the lanes above have no volume and rest undeformed.
struct Place {
    int n;  // points
    int point[lane_count] = {};

    ALWAYS_INLINE Place(const PointsOfSlaves& points, const SlaveRange& range, int b) {
        const int first = range.begin + lane_count * b;
        n = std::min(lane_count, range.end - first);
        for (int l = 0; l < n; ++l)
            point[l] = points.corner[first + l] - points.first_corner;
    }
};

ALWAYS_INLINE Matrix3<Lanes> load(const Matrix3<double>* matrices, const Place& at) {
    static const Matrix3<double> rest{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const Matrix3<double>* from[lane_count];
    std::fill(from, from + lane_count, &rest);
    for (int l = 0; l < at.n; ++l)
        from[l] = &matrices[at.point[l]];
    return load_lanes(from);
}

ALWAYS_INLINE void load(const PointsOfSlaves& points, const Place& at, Batch& batch) {
    static_assert(sizeof(PointLaw) == sizeof(Lanes));
    const PointLaw nothing{0, 1, 0, points.law[at.point[0]].model};
    Lanes law[lane_count];
    for (int l = 0; l < lane_count; ++l)
        std::memcpy(&law[l], l < at.n ? &points.law[at.point[l]] : &nothing, sizeof law[l]);
    transpose(law);
    batch.volume = law[0];
    batch.mu = law[1];
    batch.lambda = law[2];
    batch.model = law[3];
    batch.models = points.models;
    batch.n = at.n;
}

ALWAYS_INLINE Matrix3<Lanes> load(const Gradient* values, int n) {
    if (n == lane_count)
        return load_lanes(values);
    Gradient all[lane_count] = {};
    std::copy_n(values, n, all);
    return load_lanes(all);
}

ALWAYS_INLINE void store(const Matrix3<Lanes>& A, int n, Gradient* values) {
    if (n == lane_count)
        return store_lanes(A, values);
    Gradient all[lane_count];
    store_lanes(A, all);
    std::copy_n(all, n, values);
}

ALWAYS_INLINE void store(const Matrix3<Lanes>& F, const Place& at, Matrix3<double>* matrices) {
    Matrix3<double> nowhere, *to[lane_count];
    std::fill(to, to + lane_count, &nowhere);
    for (int l = 0; l < at.n; ++l)
        to[l] = &matrices[at.point[l]];
    store_lanes(F, to);
}

/// A Bᵀ.
ALWAYS_INLINE Matrix3<Lanes> product_transposed(const Matrix3<Lanes>& A,
                                                const Matrix3<Lanes>& B) {
    Matrix3<Lanes> result;
#pragma GCC unroll 9
    for (int n = 0; n < 9; ++n) {
        const int i = n % 3, j = n / 3;
        result.m[n] = A.m[i] * B.m[j] + A.m[3 + i] * B.m[3 + j] + A.m[6 + i] * B.m[6 + j];
    }
    return result;
}

ALWAYS_INLINE Matrix3<Lanes> moved(const Matrix3<Lanes>& F_n,
                                   const Matrix3<Lanes>& D,
                                   double dt) {
    Matrix3<Lanes> F = product(D, F_n);
    for (int k = 0; k < 9; ++k)
        F.m[k] = F_n.m[k] + dt * F.m[k];
    return F;
}

/// Positive in the lanes of a law.
ALWAYS_INLINE Lanes where_law(const Batch& batch, Model model) {
    const Lanes difference = batch.model - static_cast<double>(model);
    return 0.5 - difference * difference;
}

template <class Law>
ALWAYS_INLINE void take_law(
    const Batch& batch, Model model, const Matrix3<Lanes>& F, Lanes& psi, Matrix3<Lanes>& P) {
    const unsigned bit = 1u << static_cast<int>(model);
    if (!(batch.models & bit))
        return;
    Matrix3<Lanes> P_law;
    const Lanes psi_law = Law::energy_and_first_piola(F, batch.mu, batch.lambda, P_law);
    if (batch.models == bit) {
        psi = psi_law;
        P = P_law;
        return;
    }
    const Lanes is_law = where_law(batch, model);
    psi = select_positive(is_law, psi_law, psi);
    for (int k = 0; k < 9; ++k)
        P.m[k] = select_positive(is_law, P_law.m[k], P.m[k]);
}

template <class Law>
ALWAYS_INLINE void take_law_stiffness(const Batch& batch,
                                      Model model,
                                      const Matrix3<Lanes>& F,
                                      Lanes* A) {
    if (!(batch.models & 1u << static_cast<int>(model)))
        return;
    alignas(64) Lanes A_law[packed_size];
    Law::stiffness(F, uniform<Lanes>(1), Lanes(batch.lambda / batch.mu), A_law);
    const Lanes is_law = where_law(batch, model);
    for (int k = 0; k < packed_size; ++k)
        A[k] = select_positive(is_law, A_law[k], A[k]);
}

/// What a change of F_n's columns does seen from ∇v: A_(ij)(kl) = Σ_ab F_ja F_lb C_(ia)(kb).
ALWAYS_INLINE void see_from_gradients(const Matrix3<Lanes>& F, const Lanes* C, FloatLanes* A) {
    for (int i = 0; i < 3; ++i)
        for (int k = i; k < 3; ++k) {
            Matrix3<Lanes> block;
            for (int b = 0; b < 3; ++b)
                for (int a = 0; a < 3; ++a)
                    block.m[3 * b + a] = C[packed(3 * a + i, 3 * b + k)];
            const Matrix3<Lanes> seen = product(F, product_transposed(block, F));
            for (int l = 0; l < 3; ++l)
                for (int j = 0; j < 3; ++j)
                    A[packed(3 * j + i, 3 * l + k)] =
                        __builtin_convertvector(seen.m[3 * l + j], FloatLanes);
        }
}

/// Apart from the loops over lanes: it runs on scalars, seldom, and reads Eigen.
[[gnu::noinline]] void project(const Batch& batch, const Matrix3<Lanes>& F, Lanes* C) {
    for (int l = 0; l < batch.n; ++l) {
        Mat3 F_l;
        for (int k = 0; k < 9; ++k)
            F_l(k % 3, k / 3) = F.m[k][l];
        const auto model = static_cast<Model>(static_cast<int>(batch.model[l]));
        const Mat9 projected =
            projected_stiffness(model, F_l, 1, batch.lambda[l] / batch.mu[l]);
        for (int r = 0; r < 9; ++r)
            for (int c = r; c < 9; ++c)
                C[packed(r, c)][l] = projected(r, c);
    }
}

/// Whether any point of a batch may have left its limits.
ALWAYS_INLINE bool may_yield(const Yielding& yielding,
                             const Place& at,
                             const Matrix3<Lanes>& F) {
    alignas(64) Lanes low{}, high = uniform<Lanes>(2);
    for (int l = 0; l < at.n; ++l) {
        const StretchLimits& limits = yielding.limits[yielding.region[at.point[l]]];
        low[l] = limits.low;
        high[l] = limits.high;
    }
    const Lanes stays = inside(F, low, high);
    bool all_stay = true;
    for (int l = 0; l < lane_count; ++l)
        all_stay = all_stay && stays[l] > 0;
    return !all_stay;
}

/// Ψ and P at F.
ALWAYS_INLINE Matrix3<Lanes> stresses(const Batch& batch, const Matrix3<Lanes>& F, Lanes& psi) {
    Matrix3<Lanes> P{};
    psi = Lanes{};
    take_law<NeoHookean>(batch, Model::NeoHookean, F, psi, P);
    take_law<StableNeoHookean>(batch, Model::StableNeoHookean, F, psi, P);
    take_law<FixedCorotated>(batch, Model::FixedCorotated, F, psi, P);
    return P;
}

/// Sets `values` to V P F_nᵀ and returns V Ψ.
ALWAYS_INLINE Lanes take_stresses(const PointsOfSlaves& points,
                                  const Place& at,
                                  const Matrix3<Lanes>& F,
                                  const Matrix3<Lanes>& F_n,
                                  Gradient* values) {
    Batch batch;
    load(points, at, batch);
    Lanes psi;
    Matrix3<Lanes> P = stresses(batch, F, psi);
    for (int k = 0; k < 9; ++k)
        P.m[k] = batch.volume * P.m[k];
    store(product_transposed(P, F_n), at.n, values);
    return batch.volume * psi;
}

ALWAYS_INLINE double sum_of(const Lanes& lanes) {
    double sum = 0;
    for (int l = 0; l < lane_count; ++l)
        sum += lanes[l];
    return sum;
}

}  // namespace

SUPPLE_LANES
void deform(const PointsOfSlaves& points,
            const SlaveRange& range,
            double dt,
            const Gradient* values,
            Matrix3<double>* F) {
    for (int b = 0; b < range.n_batches(); ++b) {
        const Place at(points, range, b);
        const Matrix3<Lanes> D = load(values + lane_count * b, at.n);
        store(moved(load(points.F_n, at), D, dt), at, F);
    }
}

SUPPLE_LANES
double take_stresses(const PointsOfSlaves& points,
                     const SlaveRange& range,
                     const Matrix3<double>* F,
                     Gradient* values) {
    alignas(64) Lanes energy{};
    for (int b = 0; b < range.n_batches(); ++b) {
        const Place at(points, range, b);
        energy += take_stresses(
            points, at, load(F, at), load(points.F_n, at), values + lane_count * b);
    }
    return sum_of(energy);
}

SUPPLE_LANES
double deform_and_take_stresses(const PointsOfSlaves& points,
                                const SlaveRange& range,
                                const Yielding* yielding,
                                Matrix3<double>* F,
                                Gradient* values) {
    alignas(64) Lanes energy{};
    for (int b = 0; b < range.n_batches(); ++b) {
        const Place at(points, range, b);
        Gradient* const here = values + lane_count * b;
        Matrix3<Lanes> F_n = load(points.F_n, at), F_there = moved(F_n, load(here, at.n), 1);
        store(F_there, at, F);
        if (yielding != nullptr && may_yield(*yielding, at, F_there)) {
            yielding->yield(at.point, at.n);
            F_there = load(F, at);
            F_n = load(points.F_n, at);
        }
        energy += take_stresses(points, at, F_there, F_n, here);
    }
    return sum_of(energy);
}

SUPPLE_LANES
void take_stiffness(const PointsOfSlaves& points,
                    const SlaveRange& range,
                    double dt,
                    const Gradient* values,
                    bool projected,
                    PointStiffness* stiffness,
                    Lanes* weight) {
    Batch batch;
    for (int b = 0; b < range.n_batches(); ++b) {
        const Place at(points, range, b);
        load(points, at, batch);
        const Matrix3<Lanes> F_n = load(points.F_n, at),
                             F = moved(F_n, load(values + lane_count * b, at.n), dt);
        alignas(64) Lanes C[packed_size] = {};
        take_law_stiffness<NeoHookean>(batch, Model::NeoHookean, F, C);
        take_law_stiffness<StableNeoHookean>(batch, Model::StableNeoHookean, F, C);
        take_law_stiffness<FixedCorotated>(batch, Model::FixedCorotated, F, C);
        if (projected)
            project(batch, F, C);
        see_from_gradients(F_n, C, stiffness[b].A);
        weight[b] = batch.volume * batch.mu;
    }
}

SUPPLE_LANES
void multiply(const PointStiffness* stiffness,
              const Lanes* weight,
              const SlaveRange& range,
              Gradient* values) {
    for (int b = 0; b < range.n_batches(); ++b) {
        Gradient* const here = values + lane_count * b;
        const int n = std::min(lane_count, range.end - range.begin - lane_count * b);
        const Matrix3<Lanes> D = load(here, n);
        Matrix3<Lanes> result{};
#pragma GCC unroll 9
        for (int r = 0; r < 9; ++r)
#pragma GCC unroll 9
            for (int c = r; c < 9; ++c) {
                const Lanes A = __builtin_convertvector(stiffness[b].A[packed(r, c)], Lanes);
                result.m[r] += A * D.m[c];
                if (c > r)
                    result.m[c] += A * D.m[r];
            }
        for (int k = 0; k < 9; ++k)
            result.m[k] = weight[b] * result.m[k];
        store(result, n, here);
    }
}

SUPPLE_LANES
void take_diagonal(const PointStiffness* stiffness,
                   const Lanes* weight,
                   const SlaveRange& range,
                   Gradient* values) {
    for (int b = 0; b < range.n_batches(); ++b) {
        const int n = std::min(lane_count, range.end - range.begin - lane_count * b);
        Matrix3<Lanes> diagonal;
        for (int k = 0; k < 9; ++k) {
            const Lanes entry = __builtin_convertvector(stiffness[b].A[packed(k, k)], Lanes);
            diagonal.m[k] = weight[b] * select_positive(entry, entry, Lanes(-entry));
        }
        store(diagonal, n, values + lane_count * b);
    }
}

}  // namespace sim
