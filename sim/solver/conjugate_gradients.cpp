#include "sim/solver/conjugate_gradients.h"

#include "sim/base/parallel.h"

namespace sim {

namespace {

constexpr int chunk = 8192;

}  // namespace

double scaled_norm(const Field& g, const Field& d) {
    const double squared =
        sum_chunks(static_cast<int>(g.size()), chunk, [&](int begin, int end) {
            Vec3p sum{};
            for (int i = begin; i < end; ++i)
                sum += g[i] * g[i] * d[i];
            return sum[0] + sum[1] + sum[2];
        });
    return __builtin_sqrt(squared);
}

LinearSummary solve_linear(Potential& potential,
                           const Field& g,
                           double tolerance,
                           int max_iterations,
                           Field& d,
                           LinearScratch& scratch) {
    const int n = static_cast<int>(g.size());
    const Field& inverse_diagonal = potential.inverse_diagonal();
    auto& [r, p, Ap] = scratch;
    r.resize(n);
    p.resize(n);
    Ap.resize(n);
    d.assign(n, Vec3p{});

    // r = -g, z = D⁻¹ r, p = z
    double rz = sum_chunks(n, chunk, [&](int begin, int end) {
        Vec3p sum{};
        for (int i = begin; i < end; ++i) {
            r[i] = -g[i];
            p[i] = inverse_diagonal[i] * r[i];
            sum += r[i] * p[i];
        }
        return sum[0] + sum[1] + sum[2];
    });
    const double enough = tolerance * tolerance * rz;

    LinearSummary summary;
    while (rz > enough && summary.iterations < max_iterations) {
        const double curvature = potential.hessian_product(p, Ap);
        ++summary.iterations;
        if (!(curvature > 0)) {
            summary.negative_curvature = true;
            return summary;
        }
        // Two passes: the new residual and its norm; the step and the next direction, which read p once.
        const double alpha = rz / curvature;
        const double rz_next = sum_chunks(n, chunk, [&](int begin, int end) {
            Vec3p sum{};
            for (int i = begin; i < end; ++i) {
                r[i] -= alpha * Ap[i];
                sum += r[i] * r[i] * inverse_diagonal[i];
            }
            return sum[0] + sum[1] + sum[2];
        });
        const double beta = rz_next / rz;
        rz = rz_next;
        for_chunks(n, chunk, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) {
                d[i] += alpha * p[i];
                p[i] = inverse_diagonal[i] * r[i] + beta * p[i];
            }
        });
    }
    summary.converged = rz <= enough;
    return summary;
}

}  // namespace sim
