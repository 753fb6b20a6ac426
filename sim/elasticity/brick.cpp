#include "sim/elasticity/brick.h"

#include "sim/base/lane_clones.h"
#include "sim/elasticity/brick_modes.h"
#include "sim/materials/fixed_corotated.h"
#include "sim/materials/neo_hookean.h"
#include "sim/materials/stable_neo_hookean.h"

#include <algorithm>
#include <cstdlib>

namespace sim {

namespace {

/// F of a batch; the identity in empty slots. ∂x/∂X_j = h_j / (4 s).
template <class L>
ALWAYS_INLINE Matrix3<L> gradient_of_modes(const Eight<L> h[3], const L& volume, double edge) {
    Matrix3<L> F;
    times<9>([&](auto k) INLINED {
        alignas(sizeof(L)) const L entry = h[k % 3].v[linear_mode[k / 3]] * (1 / (4 * edge));
        F.m[k] = select_positive(volume, entry, uniform<L>(k % 4 == 0 ? 1 : 0));
    });
    return F;
}

/// ∂E_hg/∂h_m = k h_m for bilinear modes, k/2 h_m for the trilinear one, and 0 for the mean; returns E_hg.
template <class L>
ALWAYS_INLINE L hourglass(const L& k, const Eight<L> h[3], Eight<L> g[3]) {
    alignas(sizeof(L)) L energy{};
    times<3>([&](auto i) INLINED {
        g[i].v[0] = L{};
        times<3>([&](auto m) INLINED {
            constexpr int mode = bilinear_mode[m];
            g[i].v[mode] = k * h[i].v[mode];
            energy += g[i].v[mode] * h[i].v[mode];
        });
        g[i].v[trilinear_mode] = 0.5 * k * h[i].v[trilinear_mode];
        energy += g[i].v[trilinear_mode] * h[i].v[trilinear_mode];
    });
    return 0.5 * energy;
}

/// Positive in the slots of a law.
template <class L>
ALWAYS_INLINE L where_law(const L& law, Model model) {
    alignas(sizeof(L)) const L difference = law - static_cast<double>(model);
    return 0.5 - difference * difference;
}

template <class L>
ALWAYS_INLINE unsigned laws_of(const Brick& brick, std::size_t b) {
    return batches<L> == 1 ? brick.laws[b] : brick.laws[b] | brick.laws[b + 1];
}

template <class Law, class L>
ALWAYS_INLINE void take_law(const Brick& brick,
                            std::size_t b,
                            Model model,
                            const Matrix3<L>& F,
                            L& psi,
                            Matrix3<L>& P) {
    const unsigned bit = 1u << static_cast<int>(model), laws = laws_of<L>(brick, b);
    if (!(laws & bit))
        return;
    Matrix3<L> P_law;
    alignas(sizeof(L)) const L psi_law = Law::energy_and_first_piola(
        F, load_from<L>(brick.mu, b), load_from<L>(brick.lambda, b), P_law);
    if (laws == bit) {
        psi = psi_law;
        P = P_law;
        return;
    }
    alignas(sizeof(L)) const L is_law = where_law(load_from<L>(brick.law, b), model);
    psi = select_positive(is_law, psi_law, psi);
    for (int k = 0; k < 9; ++k)
        P.m[k] = select_positive(is_law, P_law.m[k], P.m[k]);
}

/// Adds the gradient of batch b, or of two, and returns their energies.
template <class L>
ALWAYS_INLINE L take_gradient(const Brick& brick,
                              std::size_t b,
                              double edge,
                              ModesOfCorners<L>& modes,
                              SumsAtCorners<L>& sums) {
    Eight<L> h[3], g[3];
    modes.load(b, h);
    alignas(sizeof(L)) const L volume = load_from<L>(brick.volume, b);
    const Matrix3<L> F = gradient_of_modes(h, volume, edge);

    alignas(sizeof(L)) L psi{};
    Matrix3<L> P{};
    take_law<NeoHookean>(brick, b, Model::NeoHookean, F, psi, P);
    take_law<StableNeoHookean>(brick, b, Model::StableNeoHookean, F, psi, P);
    take_law<FixedCorotated>(brick, b, Model::FixedCorotated, F, psi, P);

    alignas(sizeof(L)) const L energy =
        volume * psi + hourglass(load_from<L>(brick.hourglass, b), h, g);
    alignas(sizeof(L)) const L scale = volume * (1 / (4 * edge));
    times<9>([&](auto k) INLINED { g[k % 3].v[linear_mode[k / 3]] = scale * P.m[k]; });
    sums.add(b, g);
    return energy;
}

/// Whether two batches at once give the same to the last bit: no row of the first shares places with another row of the second,
/// where sums would come in another order, and no law iterates until all its lanes have settled.
bool may_pair(const Brick& brick, std::size_t b) {
    if (laws_of<Pair>(brick, b) & 1u << static_cast<int>(Model::FixedCorotated))
        return false;
    const std::array<int, 4>& row = brick.batch[b].row;
    for (int r = 0; r < 4; ++r)
        for (int other = 0; other < r; ++other)
            if (std::abs(row[r] - row[other]) < 2 * lane_count)
                return false;
    return true;
}

/// Where the row of batches that begins with b ends.
std::size_t end_of_row(const Brick& brick, std::size_t b) {
    do
        ++b;
    while (b < brick.batch.size() && brick.batch[b].continues);
    return b;
}

template <class Law>
ALWAYS_INLINE void take_stiffness(
    const Brick& brick, int b, Model model, const Matrix3<Lanes>& F, FloatLanes* A) {
    const unsigned bit = 1u << static_cast<int>(model);
    if (!(brick.laws[b] & bit))
        return;
    alignas(64) Lanes A_law[45];
    // Over mu; 0 / 0 stands for λ/μ in empty slots, which weigh nothing.
    const Lanes ratio =
        select_positive(brick.mu[b], Lanes(brick.lambda[b] / brick.mu[b]), Lanes{});
    Law::stiffness(F, uniform<Lanes>(1), ratio, A_law);
    const Lanes is_law = where_law(brick.law[b], model);
    for (int k = 0; k < 45; ++k)
        A[k] = __builtin_convertvector(
            select_positive(is_law, A_law[k], __builtin_convertvector(A[k], Lanes)),
            FloatLanes);
}

/// Asks for the ∂P/∂F that come some batches later (past the last one nothing is read): of a large body they come from memory,
/// and the processor, busy with sums, would not look so far by itself.
ALWAYS_INLINE void fetch_ahead(const FloatLanes* A) {
    constexpr int ahead = 8, per_line = 64 / sizeof(FloatLanes);
    for (int k = 0; k < 45; k += per_line)
        __builtin_prefetch(A + 45 * ahead + k);
}

template <class Law>
ALWAYS_INLINE void take_wave_modulus(
    const Brick& brick, int b, Model model, const Matrix3<Lanes>& F, Lanes& modulus) {
    if (brick.laws[b] & 1u << static_cast<int>(model))
        modulus = select_positive(where_law(brick.law[b], model),
                                  Law::highest_wave_modulus(F, brick.mu[b], brick.lambda[b]),
                                  modulus);
}

}  // namespace

bool has_pair_registers() {
    static const bool has = __builtin_cpu_supports("x86-64-v4");
    return has;
}

SUPPLE_LANES
double add_brick_gradient(const Brick& brick,
                          double edge,
                          const BrickFields& fields,
                          bool takes_pairs) {
    alignas(64) Lanes energy{};
    ModesOfCorners<Lanes> modes(brick, fields);
    SumsAtCorners<Lanes> sums(brick, fields);
    for (std::size_t b = 0, end = 0; b < brick.batch.size(); b = end) {
        end = end_of_row(brick, b);
        if (takes_pairs && end - b > 1 && may_pair(brick, b)) {
            ModesOfCorners<Pair> modes_of_pairs(brick, fields);
            SumsAtCorners<Pair> sums_of_pairs(brick, fields);
            for (; end - b > 1 && may_pair(brick, b); b += 2) {
                alignas(64) const Pair both =
                    take_gradient(brick, b, edge, modes_of_pairs, sums_of_pairs);
                energy += first_of(both);
                energy += second_of(both);
            }
            modes.go_on_from(modes_of_pairs);
            sums.go_on_from(sums_of_pairs);
        }
        for (; b < end; ++b)
            energy += take_gradient(brick, b, edge, modes, sums);
    }
    double sum = 0;
    for (int l = 0; l < lane_count; ++l)
        sum += energy[l];
    return sum;
}

SUPPLE_LANES
double brick_stiffening(const Brick& brick, double edge, const BrickFields& fields) {
    double most = 1;
    ModesOfCorners<Lanes> modes(brick, fields);
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        Eight<Lanes> h[3];
        modes.load(b, h);
        const Matrix3<Lanes> F = gradient_of_modes(h, brick.volume[b], edge);
        Lanes modulus{};
        take_wave_modulus<NeoHookean>(brick, b, Model::NeoHookean, F, modulus);
        take_wave_modulus<StableNeoHookean>(brick, b, Model::StableNeoHookean, F, modulus);
        take_wave_modulus<FixedCorotated>(brick, b, Model::FixedCorotated, F, modulus);
        most = std::max(most, largest_lane(Lanes(brick.wave_compliance[b] * modulus)));
    }
    return most;
}

SUPPLE_LANES
void linearize_brick(Brick& brick, double edge, const BrickFields& fields) {
    ModesOfCorners<Lanes> modes(brick, fields);
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        Eight<Lanes> h[3];
        modes.load(b, h);
        const Matrix3<Lanes> F = gradient_of_modes(h, brick.volume[b], edge);
        FloatLanes* A = &brick.stiffness[45 * b];
        take_stiffness<NeoHookean>(brick, b, Model::NeoHookean, F, A);
        take_stiffness<StableNeoHookean>(brick, b, Model::StableNeoHookean, F, A);
        take_stiffness<FixedCorotated>(brick, b, Model::FixedCorotated, F, A);
    }
}

SUPPLE_LANES
void add_brick_product(const Brick& brick, double edge, const BrickFields& fields) {
    ModesOfCorners<Lanes> modes(brick, fields);
    SumsAtCorners<Lanes> sums(brick, fields);
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        // 1/(4s) from the modes to F, and 1/(4s) back
        const Lanes scale = brick.weight[b] * (1 / (16 * edge * edge));
        Eight<Lanes> h[3], g[3];
        modes.load(b, h);
        Matrix3<Lanes> dF, dP{};
        times<9>([&](auto k) INLINED { dF.m[k] = scale * h[k % 3].v[linear_mode[k / 3]]; });
        const FloatLanes* A = &brick.stiffness[45 * b];
        fetch_ahead(A);
        times<9>([&](auto r) INLINED {
            times<9>([&](auto c) INLINED {
                if constexpr (c >= r) {
                    constexpr int entry = r * (17 - r) / 2 + c;  // of the packed upper triangle
                    const Lanes A_rc = __builtin_convertvector(A[entry], Lanes);
                    dP.m[r] += A_rc * dF.m[c];
                    if constexpr (c > r)
                        dP.m[c] += A_rc * dF.m[r];
                }
            });
        });
        hourglass(brick.hourglass[b], h, g);
        times<9>([&](auto k) INLINED { g[k % 3].v[linear_mode[k / 3]] = dP.m[k]; });
        sums.add(b, g);
    }
}

SUPPLE_LANES
void add_brick_diagonal(const Brick& brick, double edge, const BrickFields& fields) {
    // Of K_aa = Σ_jk b_j b_k V A_(ij)(ik) with b = (±1, ±1, ±1)/(4s) the terms j ≠ k change sign from one domain
    // around a corner to the next; the hourglass modes add three bilinear terms k and one trilinear k/2.
    constexpr int packed_diagonal[9] = {0, 9, 17, 24, 30, 35, 39, 42, 44};
    SumsAtCorners<Lanes> sums(brick, fields);
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        Eight<Lanes> g[3] = {};  // the same at all corners
        const FloatLanes* A = &brick.stiffness[45 * b];
        const Lanes scale = brick.weight[b] * (1 / (16 * edge * edge));
        times<3>([&](auto i) INLINED {
            const Lanes sum =
                scale
                    * __builtin_convertvector(A[packed_diagonal[i]] + A[packed_diagonal[3 + i]]
                                                  + A[packed_diagonal[6 + i]],
                                              Lanes)
                + 3.5 * brick.hourglass[b];
            g[i].v[0] = sum;
        });
        sums.add(b, g);
    }
}

SUPPLE_LANES
void find_J(const Brick& brick, double edge, const BrickFields& fields, Lanes* J) {
    ModesOfCorners<Lanes> modes(brick, fields);
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        Eight<Lanes> h[3];
        modes.load(b, h);
        J[b] = determinant(gradient_of_modes(h, brick.volume[b], edge));
    }
}

}  // namespace sim
