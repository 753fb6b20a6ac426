#include "sim/elasticity/brick.h"

#include "sim/materials/fixed_corotated.h"
#include "sim/materials/neo_hookean.h"
#include "sim/materials/stable_neo_hookean.h"

#include <algorithm>
#include <utility>

// Compiled for two instruction sets and chosen at run time; both do the same operations in every lane.
#define SUPPLE_LANES __attribute__((target_clones("arch=x86-64-v4", "default")))

namespace sim {

namespace {

#define ALWAYS_INLINE [[gnu::always_inline]] inline
#define INLINED     \
    __attribute__(( \
        always_inline))  // the same for a lambda, whose place for [[ ]] binds elsewhere

template <class Body, int... k>
ALWAYS_INLINE void unroll(const Body& body, std::integer_sequence<int, k...>) {
    (body(std::integral_constant<int, k>{}), ...);
}

/// body(0) ... body(n - 1) with constant indices: small arrays then live in registers, which loops of this size lose.
template <int n, class Body>
ALWAYS_INLINE void times(const Body& body) {
    unroll(body, std::make_integer_sequence<int, n>{});
}

ALWAYS_INLINE void add_to(double* p, const Lanes& v) {
    store_lanes(load_lanes(p) + v, p);
}

/// The eight values of one component, at the corners or as coefficients of the modes.
struct alignas(sizeof(Lanes)) Eight {
    Lanes v[8];
};

/// Values at the eight corners -> coefficients h_m = Σ_a ξ_m(a) v_a of the modes 1, ξ, η, ξη, ζ, ξζ, ηζ, ξηζ with
/// ξ, η, ζ = ±1 at the corners, so that v(ξ,η,ζ) = Σ_m h_m/8 ξ_m (the Walsh-Hadamard transform of size 8).
ALWAYS_INLINE void to_modes(Eight& e) {
    times<3>([&](auto axis) INLINED {
        times<8>([&](auto a) INLINED {
            constexpr int bit = 1 << axis;
            if constexpr (!(a & bit)) {
                const Lanes low = e.v[a], high = e.v[a | bit];
                e.v[a] = low + high;
                e.v[a | bit] = high - low;
            }
        });
    });
}

/// The transpose of to_modes: ∂/∂v_a = Σ_m ξ_m(a) ∂/∂h_m.
ALWAYS_INLINE void from_modes(Eight& e) {
    times<3>([&](auto axis) INLINED {
        times<8>([&](auto a) INLINED {
            constexpr int bit = 1 << axis;
            if constexpr (!(a & bit)) {
                const Lanes low = e.v[a], high = e.v[a | bit];
                e.v[a] = low - high;
                e.v[a | bit] = low + high;
            }
        });
    });
}

// Modes by kind: the three linear ones carry F, the three bilinear and the trilinear one are hourglass modes.
constexpr int linear_mode[3] = {1, 2, 4};
constexpr int bilinear_mode[3] = {3, 5, 6};
constexpr int trilinear_mode = 7;

ALWAYS_INLINE void load_modes(const std::array<int, 4>& row,
                              const BrickFields& fields,
                              Eight h[3]) {
    times<3>([&](auto i) INLINED {
        times<8>([&](auto a)
                     INLINED { h[i].v[a] = load_lanes(fields.in[i] + row[a / 2] + (a & 1)); });
        to_modes(h[i]);
    });
}

/// Where sums for corner a of component i go, seen from the corner of the same row on the left.
ALWAYS_INLINE double* corner_sums(const BrickFields& fields, int i, int a) {
    return a & 1 ? fields.out_right[i] : fields.out[i];
}

ALWAYS_INLINE void add_modes(const std::array<int, 4>& row,
                             const BrickFields& fields,
                             Eight g[3]) {
    times<3>([&](auto i) INLINED {
        g[i].v[0] = Lanes{};
        from_modes(g[i]);
        times<8>([&](auto a)
                     INLINED { add_to(corner_sums(fields, i, a) + row[a / 2], g[i].v[a]); });
    });
}

/// F of a batch; the identity in empty slots. ∂x/∂X_j = h_j / (4 s).
ALWAYS_INLINE Matrix3<Lanes> gradient_of_modes(const Eight h[3],
                                               const Lanes& volume,
                                               double edge) {
    Matrix3<Lanes> F;
    times<9>([&](auto k) INLINED {
        const Lanes entry = h[k % 3].v[linear_mode[k / 3]] * (1 / (4 * edge));
        F.m[k] = select_positive(volume, entry, uniform<Lanes>(k % 4 == 0 ? 1 : 0));
    });
    return F;
}

/// ∂E_hg/∂h_m = k h_m for bilinear modes, k/2 h_m for the trilinear one; returns E_hg.
ALWAYS_INLINE Lanes hourglass(const Lanes& k, const Eight h[3], Eight g[3]) {
    Lanes energy{};
    times<3>([&](auto i) INLINED {
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
ALWAYS_INLINE Lanes where_law(const Lanes& law, Model model) {
    const Lanes difference = law - static_cast<double>(model);
    return 0.5 - difference * difference;
}

template <class Law>
ALWAYS_INLINE void take_law(const Brick& brick,
                            int b,
                            Model model,
                            const Matrix3<Lanes>& F,
                            Lanes& psi,
                            Matrix3<Lanes>& P) {
    const unsigned bit = 1u << static_cast<int>(model);
    if (!(brick.laws[b] & bit))
        return;
    Matrix3<Lanes> P_law;
    const Lanes psi_law = Law::energy_and_first_piola(F, brick.mu[b], brick.lambda[b], P_law);
    if (brick.laws[b] == bit) {
        psi = psi_law;
        P = P_law;
        return;
    }
    const Lanes is_law = where_law(brick.law[b], model);
    psi = select_positive(is_law, psi_law, psi);
    for (int k = 0; k < 9; ++k)
        P.m[k] = select_positive(is_law, P_law.m[k], P.m[k]);
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

SUPPLE_LANES
double add_brick_gradient(const Brick& brick, double edge, const BrickFields& fields) {
    Lanes energy{};
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        Eight h[3], g[3];
        load_modes(brick.batch[b].row, fields, h);
        const Matrix3<Lanes> F = gradient_of_modes(h, brick.volume[b], edge);

        Lanes psi{};
        Matrix3<Lanes> P{};
        take_law<NeoHookean>(brick, b, Model::NeoHookean, F, psi, P);
        take_law<StableNeoHookean>(brick, b, Model::StableNeoHookean, F, psi, P);
        take_law<FixedCorotated>(brick, b, Model::FixedCorotated, F, psi, P);

        energy += brick.volume[b] * psi + hourglass(brick.hourglass[b], h, g);
        const Lanes scale = brick.volume[b] * (1 / (4 * edge));
        times<9>([&](auto k) INLINED { g[k % 3].v[linear_mode[k / 3]] = scale * P.m[k]; });
        add_modes(brick.batch[b].row, fields, g);
    }
    double sum = 0;
    for (int l = 0; l < lane_count; ++l)
        sum += energy[l];
    return sum;
}

SUPPLE_LANES
double brick_stiffening(const Brick& brick, double edge, const BrickFields& fields) {
    double most = 1;
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        Eight h[3];
        load_modes(brick.batch[b].row, fields, h);
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
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        Eight h[3];
        load_modes(brick.batch[b].row, fields, h);
        const Matrix3<Lanes> F = gradient_of_modes(h, brick.volume[b], edge);
        FloatLanes* A = &brick.stiffness[45 * b];
        take_stiffness<NeoHookean>(brick, b, Model::NeoHookean, F, A);
        take_stiffness<StableNeoHookean>(brick, b, Model::StableNeoHookean, F, A);
        take_stiffness<FixedCorotated>(brick, b, Model::FixedCorotated, F, A);
    }
}

SUPPLE_LANES
void add_brick_product(const Brick& brick, double edge, const BrickFields& fields) {
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        // 1/(4s) from the modes to F, and 1/(4s) back
        const Lanes scale = brick.weight[b] * (1 / (16 * edge * edge));
        Eight h[3], g[3];
        load_modes(brick.batch[b].row, fields, h);
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
        add_modes(brick.batch[b].row, fields, g);
    }
}

SUPPLE_LANES
void add_brick_diagonal(const Brick& brick, double edge, const BrickFields& fields) {
    // Of K_aa = Σ_jk b_j b_k V A_(ij)(ik) with b = (±1, ±1, ±1)/(4s) the terms j ≠ k change sign from one domain
    // around a corner to the next; the hourglass modes add three bilinear terms k and one trilinear k/2.
    constexpr int packed_diagonal[9] = {0, 9, 17, 24, 30, 35, 39, 42, 44};
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        const FloatLanes* A = &brick.stiffness[45 * b];
        const Lanes scale = brick.weight[b] * (1 / (16 * edge * edge));
        times<3>([&](auto i) INLINED {
            const Lanes sum =
                scale
                    * __builtin_convertvector(A[packed_diagonal[i]] + A[packed_diagonal[3 + i]]
                                                  + A[packed_diagonal[6 + i]],
                                              Lanes)
                + 3.5 * brick.hourglass[b];
            times<8>([&](auto a) INLINED {
                add_to(corner_sums(fields, i, a) + brick.batch[b].row[a / 2], sum);
            });
        });
    }
}

Lanes brick_J(const Brick& brick, int b, double edge, const BrickFields& fields) {
    Eight h[3];
    load_modes(brick.batch[b].row, fields, h);
    return determinant(gradient_of_modes(h, brick.volume[b], edge));
}

}  // namespace sim
