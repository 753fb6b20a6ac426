#include "sim/solver/conjugate_gradients.h"
#include "tests/unit/sim/solver/dense_potential.h"

#include <catch2/catch.hpp>

using namespace tests;

namespace {

constexpr int n = 30;

struct Solved {
    sim::LinearSummary summary;
    VectorXd d;
};

Solved solve(DensePotential& potential,
             const VectorXd& g,
             double tolerance,
             int max_iterations = 1000) {
    potential.linearize(to_field(VectorXd::Zero(n)), false);
    sim::LinearScratch scratch;
    sim::Field d;
    Solved solved;
    solved.summary =
        sim::solve_linear(potential, to_field(g), tolerance, max_iterations, d, scratch);
    solved.d = to_vector(d);
    return solved;
}

}  // namespace

TEST_CASE("conjugate gradients agree with a dense factorization") {
    const MatrixXd A = symmetric(n, 1, 1e3);
    const VectorXd g = VectorXd::LinSpaced(n, -1, 2);
    DensePotential potential(quadratic(A, g));
    const Solved solved = solve(potential, g, 1e-13);
    CHECK(solved.summary.converged);
    CHECK(!solved.summary.negative_curvature);
    const VectorXd expected = -A.ldlt().solve(g);
    CHECK((solved.d - expected).norm() <= 1e-10 * expected.norm());
}

TEST_CASE("conjugate gradients stop at the first iterate within the tolerance") {
    const MatrixXd A = symmetric(n, 1, 1e3);
    const VectorXd g = VectorXd::LinSpaced(n, -1, 2);
    DensePotential potential(quadratic(A, g));
    const auto residual = [&](const VectorXd& d) {
        return sim::scaled_norm(to_field(A * d + g), potential.inverse_diagonal());
    };
    int before = 0;
    for (const double tolerance : {0.5, 1e-2, 1e-4}) {
        const Solved solved = solve(potential, g, tolerance);
        CAPTURE(tolerance);
        CHECK(solved.summary.converged);
        CHECK(residual(solved.d) <= tolerance * residual(VectorXd::Zero(n)));
        CHECK(solved.summary.iterations > before);
        before = solved.summary.iterations;
        const Solved shorter = solve(potential, g, tolerance, before - 1);
        CHECK(!shorter.summary.converged);
        CHECK(residual(shorter.d) > tolerance * residual(VectorXd::Zero(n)));
    }
}

TEST_CASE("components that are held stay zero and do not disturb the others") {
    const MatrixXd A = symmetric(n, 1, 50);
    const VectorXd g = VectorXd::LinSpaced(n, -1, 2);
    DensePotential potential(quadratic(A, g));
    potential.held = {0, 7, 8, 29};
    const Solved solved = solve(potential, g, 1e-13);
    std::vector<int> free;
    for (int i = 0; i < n; ++i)
        if (std::find(potential.held.begin(), potential.held.end(), i) == potential.held.end())
            free.push_back(i);
    const VectorXd expected = -MatrixXd(A(free, free)).ldlt().solve(VectorXd(g(free)));
    CHECK((VectorXd(solved.d(free)) - expected).norm() <= 1e-11 * expected.norm());
    for (const int i : potential.held)
        CHECK(solved.d[i] == 0);
}

TEST_CASE("negative curvature is told, and no gradient needs no iteration") {
    const VectorXd g = VectorXd::LinSpaced(n, -1, 2);
    DensePotential indefinite(quadratic(symmetric(n, -1, 10), g));
    const Solved solved = solve(indefinite, g, 1e-10);
    CHECK(solved.summary.negative_curvature);
    CHECK(!solved.summary.converged);

    DensePotential definite(quadratic(symmetric(n, 1, 10), g));
    const Solved at_rest = solve(definite, VectorXd::Zero(n), 1e-10);
    CHECK(at_rest.summary.converged);
    CHECK(at_rest.summary.iterations == 0);
    CHECK(at_rest.d.norm() == 0);
}
