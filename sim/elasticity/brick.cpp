#include "sim/elasticity/brick.h"

#include "sim/materials/fixed_corotated.h"
#include "sim/materials/neo_hookean.h"
#include "sim/materials/stable_neo_hookean.h"

#include <cstring>

// Compiled for two instruction sets and chosen at run time; both do the same operations in every lane.
#define SUPPLE_LANES __attribute__((target_clones("arch=x86-64-v4", "default")))

namespace sim {

namespace {

#define ALWAYS_INLINE [[gnu::always_inline]] inline

ALWAYS_INLINE Lanes load(const double* p) {
    Lanes v;
    std::memcpy(&v, p, sizeof v);
    return v;
}

ALWAYS_INLINE void add_to(double* p, const Lanes& v) {
    const Lanes sum = load(p) + v;
    std::memcpy(p, &sum, sizeof sum);
}

/// Values at the eight corners -> coefficients h_m = Σ_a ξ_m(a) v_a of the modes 1, ξ, η, ξη, ζ, ξζ, ηζ, ξηζ with
/// ξ, η, ζ = ±1 at the corners, so that v(ξ,η,ζ) = Σ_m h_m/8 ξ_m (the Walsh-Hadamard transform of size 8).
ALWAYS_INLINE void to_modes(Lanes v[8]) {
    for (int bit = 1; bit < 8; bit *= 2)
        for (int a = 0; a < 8; ++a)
            if (!(a & bit)) {
                const Lanes low = v[a], high = v[a | bit];
                v[a] = low + high;
                v[a | bit] = high - low;
            }
}

/// The transpose of to_modes: ∂/∂v_a = Σ_m ξ_m(a) ∂/∂h_m.
ALWAYS_INLINE void from_modes(Lanes g[8]) {
    for (int bit = 1; bit < 8; bit *= 2)
        for (int a = 0; a < 8; ++a)
            if (!(a & bit)) {
                const Lanes low = g[a], high = g[a | bit];
                g[a] = low - high;
                g[a | bit] = low + high;
            }
}

// Modes by kind: the three linear ones carry F, the three bilinear and the trilinear one are hourglass modes.
constexpr int linear_mode[3] = {1, 2, 4};
constexpr int bilinear_mode[3] = {3, 5, 6};
constexpr int trilinear_mode = 7;

ALWAYS_INLINE void load_modes(const Brick& brick, const double* values, int slot, Lanes v[8]) {
    for (int a = 0; a < 8; ++a)
        v[a] = load(values + slot + brick.step[a]);
    to_modes(v);
}

ALWAYS_INLINE void add_modes(const Brick& brick, double* values, int slot, Lanes g[8]) {
    from_modes(g);
    for (int a = 0; a < 8; ++a)
        add_to(values + slot + brick.step[a], g[a]);
}

/// F of a batch; the identity in empty slots. ∂x/∂X_j = h_j / (4 s).
ALWAYS_INLINE Matrix3<Lanes> gradient_of_modes(const Lanes h[3][8], double edge) {
    Matrix3<Lanes> F;
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
            F.m[3 * j + i] = h[i][linear_mode[j]] * (1 / (4 * edge));
    return F;
}

ALWAYS_INLINE void set_identity_where_empty(const Lanes& volume, Matrix3<Lanes>& F) {
    for (int k = 0; k < 9; ++k)
        F.m[k] = select_positive(volume, F.m[k], uniform<Lanes>(k % 4 == 0 ? 1 : 0));
}

/// ∂E_hg/∂h_m = k h_m for bilinear modes, k/2 h_m for the trilinear one; returns E_hg.
ALWAYS_INLINE Lanes hourglass(const Lanes& k, const Lanes h[3][8], Lanes g[3][8]) {
    Lanes energy{};
    for (int i = 0; i < 3; ++i) {
        for (const int m : bilinear_mode) {
            g[i][m] = k * h[i][m];
            energy += g[i][m] * h[i][m];
        }
        g[i][trilinear_mode] = 0.5 * k * h[i][trilinear_mode];
        energy += g[i][trilinear_mode] * h[i][trilinear_mode];
    }
    return 0.5 * energy;
}

/// Positive in the slots of a law.
ALWAYS_INLINE Lanes where_law(const Lanes& law, Model model) {
    const Lanes difference = law - static_cast<double>(model);
    return 0.5 - difference * difference;
}

template <class Law>
ALWAYS_INLINE void take_law(const Brick& brick, int b, Model model, const Matrix3<Lanes>& F, Lanes& psi,
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
ALWAYS_INLINE void take_stiffness(const Brick& brick, int b, Model model, const Matrix3<Lanes>& F, Lanes* A) {
    const unsigned bit = 1u << static_cast<int>(model);
    if (!(brick.laws[b] & bit))
        return;
    alignas(64) Lanes A_law[45];
    Law::stiffness(F, brick.mu[b], brick.lambda[b], A_law);
    const Lanes is_law = where_law(brick.law[b], model);
    for (int k = 0; k < 45; ++k)
        A[k] = select_positive(is_law, brick.volume[b] * A_law[k], A[k]);
}

}  // namespace

SUPPLE_LANES
double add_brick_gradient(const Brick& brick, double edge, const BrickFields& fields) {
    Lanes energy{};
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        const int slot = brick.batch[b];
        alignas(64) Lanes h[3][8], g[3][8];
        for (int i = 0; i < 3; ++i)
            load_modes(brick, fields.in[i], slot, h[i]);
        Matrix3<Lanes> F = gradient_of_modes(h, edge), P{};
        set_identity_where_empty(brick.volume[b], F);

        Lanes psi{};
        take_law<NeoHookean>(brick, b, Model::NeoHookean, F, psi, P);
        take_law<StableNeoHookean>(brick, b, Model::StableNeoHookean, F, psi, P);
        take_law<FixedCorotated>(brick, b, Model::FixedCorotated, F, psi, P);

        energy += brick.volume[b] * psi + hourglass(brick.hourglass[b], h, g);
        const Lanes scale = brick.volume[b] * (1 / (4 * edge));
        for (int i = 0; i < 3; ++i) {
            g[i][0] = Lanes{};
            for (int j = 0; j < 3; ++j)
                g[i][linear_mode[j]] = scale * P.m[3 * j + i];
            add_modes(brick, fields.out[i], slot, g[i]);
        }
    }
    double sum = 0;
    for (int l = 0; l < lane_count; ++l)
        sum += energy[l];
    return sum;
}

SUPPLE_LANES
void linearize_brick(Brick& brick, double edge, const BrickFields& fields) {
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        alignas(64) Lanes h[3][8];
        for (int i = 0; i < 3; ++i)
            load_modes(brick, fields.in[i], brick.batch[b], h[i]);
        Matrix3<Lanes> F = gradient_of_modes(h, edge);
        set_identity_where_empty(brick.volume[b], F);
        Lanes* A = &brick.stiffness[45 * b];
        take_stiffness<NeoHookean>(brick, b, Model::NeoHookean, F, A);
        take_stiffness<StableNeoHookean>(brick, b, Model::StableNeoHookean, F, A);
        take_stiffness<FixedCorotated>(brick, b, Model::FixedCorotated, F, A);
    }
}

SUPPLE_LANES
void add_brick_product(const Brick& brick, double edge, const BrickFields& fields) {
    const double scale = 1 / (16 * edge * edge);  // 1/(4s) from the modes to F and back
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        const int slot = brick.batch[b];
        alignas(64) Lanes h[3][8], g[3][8];
        for (int i = 0; i < 3; ++i)
            load_modes(brick, fields.in[i], slot, h[i]);
        alignas(64) Lanes dF[9], dP[9] = {};
        for (int r = 0; r < 9; ++r)
            dF[r] = scale * h[r % 3][linear_mode[r / 3]];
        const Lanes* A = &brick.stiffness[45 * b];
        for (int r = 0; r < 9; ++r) {
            dP[r] += *A++ * dF[r];
            for (int c = r + 1; c < 9; ++c, ++A) {
                dP[r] += *A * dF[c];
                dP[c] += *A * dF[r];
            }
        }
        hourglass(brick.hourglass[b], h, g);
        for (int i = 0; i < 3; ++i) {
            g[i][0] = Lanes{};
            for (int j = 0; j < 3; ++j)
                g[i][linear_mode[j]] = dP[3 * j + i];
            add_modes(brick, fields.out[i], slot, g[i]);
        }
    }
}

SUPPLE_LANES
void add_brick_diagonal(const Brick& brick, double edge, const BrickFields& fields) {
    // Of K_aa = Σ_jk b_j b_k V A_(ij)(ik) with b = (±1, ±1, ±1)/(4s) the terms j ≠ k change sign from one domain
    // around a corner to the next; the hourglass modes add three bilinear terms k and one trilinear k/2.
    constexpr int packed_diagonal[9] = {0, 9, 17, 24, 30, 35, 39, 42, 44};
    for (std::size_t b = 0; b < brick.batch.size(); ++b) {
        const Lanes* A = &brick.stiffness[45 * b];
        for (int i = 0; i < 3; ++i) {
            Lanes sum{};
            for (int j = 0; j < 3; ++j)
                sum += A[packed_diagonal[3 * j + i]];
            const Lanes value = sum * (1 / (16 * edge * edge)) + 3.5 * brick.hourglass[b];
            for (int a = 0; a < 8; ++a)
                add_to(fields.out[i] + brick.batch[b] + brick.step[a], value);
        }
    }
}

Lanes brick_J(const Brick& brick, int b, double edge, const BrickFields& fields) {
    alignas(64) Lanes h[3][8];
    for (int i = 0; i < 3; ++i)
        load_modes(brick, fields.in[i], brick.batch[b], h[i]);
    Matrix3<Lanes> F = gradient_of_modes(h, edge);
    set_identity_where_empty(brick.volume[b], F);
    return determinant(F);
}

}  // namespace sim
