#include "sim/elasticity/fbar.h"

#include "sim/base/lane_clones.h"
#include "sim/materials/law.h"
#include "sim/materials/packed_stiffness.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#define INLINED __attribute__((always_inline))

namespace sim {

namespace {

[[gnu::always_inline]] inline double sum_of(const GaussLanes& v) {
    return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

[[gnu::always_inline]] inline double least_of(const GaussLanes& v) {
    double least = v[0];
    for (int l = 1; l < 8; ++l)
        least = v[l] < least || v[l] != v[l] ? v[l] : least;
    return least;
}

/// x^⅓ for x > 0 by Halley's method, which converges from 1 for all of them, the last steps cubically.
[[gnu::always_inline]] inline GaussLanes cube_root(const GaussLanes& x) {
    constexpr int most_steps = 1100;  // each at least halves or doubles a root that is far off
    GaussLanes y = uniform<GaussLanes>(1);
    for (int step = 0; step < most_steps; ++step) {
        const GaussLanes cube = y * y * y;
        const GaussLanes ratio = (cube + 2.0 * x) / (2.0 * cube + x);
        y = y * ratio;
        const GaussLanes change = (ratio - 1.0) * (ratio - 1.0);
        if (!(sum_of(change) > 1e-12))  // the error is now the cube of 1e-6
            break;
    }
    return y;
}

/// F and what follows from it, at the Gauss points (S = GaussLanes) or the centre (double).
template <class S>
struct Deformation {
    Matrix3<S> F, inverse_transposed;
    S J;
};

template <class S>
[[gnu::always_inline]] inline void complete(Deformation<S>& d) {
    const Matrix3<S> C = cofactor(d.F);
    d.J = determinant(d.F, C);
    for (int k = 0; k < 9; ++k)
        d.inverse_transposed.m[k] = C.m[k] / d.J;
}

[[gnu::always_inline]] inline Deformation<GaussLanes> at_points(const CubeGradients& b,
                                                                const CornerValues& x) {
    // By halves: vectors of four live in registers on both instruction sets.
    alignas(64) double F[9][8];
    for (int k = 0; k < 9; ++k)
        for (const int half : {0, 4}) {
            Lanes sum{};
            for (int a = 0; a < 8; ++a)
                sum += x[8 * (k % 3) + a] * load_lanes(&b.at_points[a][k / 3][half]);
            store_lanes(sum, &F[k][half]);
        }
    Deformation<GaussLanes> d;
    std::memcpy(d.F.m, F, sizeof F);
    complete(d);
    return d;
}

[[gnu::always_inline]] inline Deformation<double> at_centre(const CubeGradients& b,
                                                            const CornerValues& x) {
    Deformation<double> d;
    for (int k = 0; k < 9; ++k) {
        d.F.m[k] = 0;
        for (int a = 0; a < 8; ++a)
            d.F.m[k] += b.at_centre[k / 3][a] * x[8 * (k % 3) + a];
    }
    complete(d);
    return d;
}

/// out_(ia) += Σ_j M_ij b_ja, M the matrix at one point.
[[gnu::always_inline]] inline void add_row_products(const double M[9],
                                                    const double b[3][8],
                                                    double out[24]) {
    for (int i = 0; i < 3; ++i)
        for (const int half : {0, 4}) {
            double* const at = out + 8 * i + half;
            store_lanes(load_lanes(at) + M[i] * load_lanes(&b[0][half])
                            + M[3 + i] * load_lanes(&b[1][half])
                            + M[6 + i] * load_lanes(&b[2][half]),
                        at);
        }
}

/// Numbers at the eight points as a plain table: a lane chosen at run time costs a copy of all.
template <int n>
struct Table {
    double value[n][8];

    [[gnu::always_inline]] explicit Table(const GaussLanes* lanes) {
        std::memcpy(value, lanes, sizeof value);
    }

    /// Those of one point.
    [[gnu::always_inline]] void take(int g, double* out) const {
        for (int k = 0; k < n; ++k)
            out[k] = value[k][g];
    }
};

/// What one point adds to K: Bᵀ A B + t zᵀ + z tᵀ + p G.
struct PointStiffness {
    double A[9][9], p;
    double g[24], t[24], z[24];  // F^-T b; derivative of ln(J_c/J_g); what t is paired with

    [[gnu::always_inline]] void add_to(const double b[3][8], double* K) const {
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 8; ++a) {
                const int row = 8 * i + a;
                double bA[9];
                for (int k = 0; k < 9; ++k)
                    bA[k] = b[0][a] * A[i][k] + b[1][a] * A[3 + i][k] + b[2][a] * A[6 + i][k];
                for (int k = 0; k < 3; ++k) {
                    const double pg = p * g[8 * k + a];
                    for (const int half : {0, 4}) {
                        double* const at = K + 24 * row + 8 * k + half;
                        store_lanes(load_lanes(at) + bA[k] * load_lanes(&b[0][half])
                                        + bA[3 + k] * load_lanes(&b[1][half])
                                        + bA[6 + k] * load_lanes(&b[2][half])
                                        + t[row] * load_lanes(&z[8 * k + half])
                                        + z[row] * load_lanes(&t[8 * k + half])
                                        + pg * load_lanes(&g[8 * i + half]),
                                    at);
                    }
                }
            }
    }
};

[[gnu::always_inline]] inline Matrix3<GaussLanes> scaled(const GaussLanes& factor,
                                                         const Matrix3<GaussLanes>& M) {
    Matrix3<GaussLanes> result;
    for (int k = 0; k < 9; ++k)
        result.m[k] = factor * M.m[k];
    return result;
}

/// What the stiffness of a point is made of, of all eight.
struct PointTables {
    Table<packed_size> A;
    Table<9> F, inverse_transposed, stress;  // stress: r P̄
    Table<1> p;

    [[gnu::always_inline]] PointTables(const GaussLanes* stiffness,
                                       const Deformation<GaussLanes>& at,
                                       const Matrix3<GaussLanes>& r_P_bar,
                                       const GaussLanes& pressure)
        : A(stiffness),
          F(at.F.m),
          inverse_transposed(at.inverse_transposed.m),
          stress(r_P_bar.m),
          p(&pressure) {}

    /// z = (A F + r P̄) b / 3 + (F : A F / 18 + p/6) t.
    [[gnu::always_inline]] PointStiffness stiffness_at(int g,
                                                       const double b[3][8],
                                                       const double g_centre[24]) const {
        PointStiffness point{};
        double A_g[packed_size], F_g[9], inverse[9], third[9];
        A.take(g, A_g);
        F.take(g, F_g);
        inverse_transposed.take(g, inverse);
        stress.take(g, third);
        point.p = p.value[0][g];
        for (int row = 0; row < 9; ++row)
            for (int column = row; column < 9; ++column)
                point.A[row][column] = point.A[column][row] = A_g[packed(row, column)];
        double FAF = 0;
        for (int k = 0; k < 9; ++k) {
            double AF = 0;
            for (int n = 0; n < 9; ++n)
                AF += point.A[n][k] * F_g[n];
            FAF += F_g[k] * AF;
            third[k] = (AF + third[k]) / 3;
        }
        add_row_products(inverse, b, point.g);
        add_row_products(third, b, point.z);
        for (int n = 0; n < 24; ++n) {
            point.t[n] = g_centre[n] - point.g[n];
            point.z[n] += (FAF / 18 + point.p / 6) * point.t[n];
        }
        return point;
    }
};

/// weight (K - p G_c), with G_c of g_c as G of g. Rounding differs between the triangles, and CG wants a symmetric matrix.
[[gnu::always_inline]] inline void write_symmetric(
    const double* K, const double* g_centre, double p, double weight, float* stiffness) {
    for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 8; ++a)
            for (int k = 0; k < 3; ++k)
                for (int c = 0; c < 8; ++c) {
                    const int entry = 24 * (8 * i + a) + 8 * k + c;
                    stiffness[entry] = static_cast<float>(
                        weight * (K[entry] - p * g_centre[8 * k + a] * g_centre[8 * i + c]));
                }
    for (int row = 0; row < 24; ++row)
        for (int column = 0; column < row; ++column)
            stiffness[24 * row + column] = stiffness[24 * column + row];
}

}  // namespace

CubeGradients::CubeGradients(double s) {
    const double xi = 1 / std::sqrt(3.0);
    for (int a = 0; a < 8; ++a)
        for (int j = 0; j < 3; ++j) {
            const auto side = [](int bits, int axis) { return bits >> axis & 1 ? 1.0 : -1.0; };
            at_centre[j][a] = side(a, j) / (4 * s);
            for (int g = 0; g < 8; ++g) {
                double slope = side(a, j) / s;
                for (int k = 0; k < 3; ++k)
                    if (k != j)
                        slope *= (1 + side(a, k) * side(g, k) * xi) / 2;
                at_points[a][j][g] = of_point[g][j][a] = slope;
            }
        }
}

SUPPLE_LANES
double fbar_gradient(const CubeGradients& b,
                     const FbarDomain& domain,
                     const CornerValues& x,
                     CornerValues& gradient) {
    const Deformation<GaussLanes> at = at_points(b, x);
    const Deformation<double> centre = at_centre(b, x);
    if (!(centre.J > 0) || !(least_of(at.J) > 0))
        return std::numeric_limits<double>::infinity();
    const GaussLanes r = cube_root(centre.J / at.J);
    const Matrix3<GaussLanes> F_bar = scaled(r, at.F);
    Matrix3<GaussLanes> P_bar;
    GaussLanes psi{};
    visit(domain.model, [&](auto law) INLINED {
        psi = law.energy_and_first_piola(
            F_bar, uniform<GaussLanes>(domain.mu), uniform<GaussLanes>(domain.lambda), P_bar);
    });
    const GaussLanes p = inner(P_bar, F_bar) / 3.0;
    Matrix3<GaussLanes> P;
    for (int k = 0; k < 9; ++k)
        P.m[k] = r * P_bar.m[k] - p * at.inverse_transposed.m[k];

    double forces[24]{}, of_centre[24]{};
    const Table<9> P_table(P.m);
    for (int g = 0; g < 8; ++g) {
        double P_g[9];
        P_table.take(g, P_g);
        add_row_products(P_g, b.of_point[g], forces);
    }
    add_row_products(centre.inverse_transposed.m, b.at_centre, of_centre);
    const double weight = domain.volume / 8, p_sum = sum_of(p);
    for (int n = 0; n < 24; ++n)
        gradient[n] = weight * (forces[n] + p_sum * of_centre[n]);
    return weight * sum_of(psi);
}

SUPPLE_LANES
void fbar_stiffness(const CubeGradients& b,
                    const FbarDomain& domain,
                    const CornerValues& x,
                    float* stiffness) {
    const Deformation<GaussLanes> at = at_points(b, x);
    const Deformation<double> centre = at_centre(b, x);
    const GaussLanes r = cube_root(centre.J / at.J);
    const Matrix3<GaussLanes> F_bar = scaled(r, at.F);
    Matrix3<GaussLanes> P_bar;
    alignas(64) GaussLanes A[packed_size];
    visit(domain.model, [&](auto law) INLINED {
        const GaussLanes mu = uniform<GaussLanes>(domain.mu),
                         lambda = uniform<GaussLanes>(domain.lambda);
        law.energy_and_first_piola(F_bar, mu, lambda, P_bar);
        law.stiffness(F_bar, mu, lambda, A);
    });
    const GaussLanes p = inner(P_bar, F_bar) / 3.0;

    for (GaussLanes& entry : A)
        entry = r * r * entry;
    const PointTables tables(A, at, scaled(r, P_bar), p);
    double K[24 * 24]{}, g_centre[24]{};
    add_row_products(centre.inverse_transposed.m, b.at_centre, g_centre);
    for (int g = 0; g < 8; ++g)
        tables.stiffness_at(g, b.of_point[g], g_centre).add_to(b.of_point[g], K);
    write_symmetric(K, g_centre, sum_of(p), domain.volume / 8, stiffness);
}

double fbar_wave_modulus(const CubeGradients& b,
                         const FbarDomain& domain,
                         const CornerValues& x) {
    const Matrix3<double> F = at_centre(b, x).F;
    return visit(domain.model, [&](auto law) {
        return law.highest_wave_modulus(F, domain.mu, domain.lambda);
    });
}

double fbar_smallest_J(const CubeGradients& b, const CornerValues& x) {
    return std::min(at_centre(b, x).J, least_of(at_points(b, x).J));
}

SUPPLE_LANES
void fbar_product(const float* stiffness, const CornerValues& u, CornerValues& out) {
    double sum[24]{};
    for (int column = 0; column < 24; ++column)
        for (int row = 0; row < 24; ++row)
            sum[row] += static_cast<double>(stiffness[24 * column + row]) * u[column];
    std::copy(sum, sum + 24, out.begin());
}

}  // namespace sim
