#include "sim/solver/newton.h"
#include "tests/unit/sim/solver/dense_potential.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace tests;
using sim::NewtonOptions;
using sim::NewtonSummary;
using sim::Termination;

namespace {

NewtonSummary minimize(DensePotential& potential, VectorXd& q, const NewtonOptions& options) {
    sim::NewtonScratch scratch;
    sim::Field field = to_field(q);
    const NewtonSummary summary = sim::minimize(potential, options, field, scratch);
    q = to_vector(field);
    return summary;
}

NewtonOptions within(double tolerance, int max_iterations = 100) {
    NewtonOptions options;
    options.tolerance = tolerance;
    options.max_iterations = max_iterations;
    return options;
}

/// Rosenbrock's valley (1 - a)² + 100 (b - a²)², and c²; its minimum is (1, 1, 0).
Functions valley() {
    return {[](const VectorXd& q) {
                return std::pow(1 - q[0], 2) + 100 * std::pow(q[1] - q[0] * q[0], 2)
                       + q[2] * q[2];
            },
            [](const VectorXd& q) -> VectorXd {
                const double b = q[1] - q[0] * q[0];
                return Vec3(-2 * (1 - q[0]) - 400 * q[0] * b, 200 * b, 2 * q[2]);
            },
            [](const VectorXd& q) -> MatrixXd {
                Mat3 H = Vec3(2 - 400 * (q[1] - 3 * q[0] * q[0]), 200, 2).asDiagonal();
                H(0, 1) = H(1, 0) = -400 * q[0];
                return H;
            }};
}

/// Σ (q² - 1)² / 4: concave for |q| < 1/√3, minima at ±1.
Functions double_well() {
    return {[](const VectorXd& q) { return (q.array().square() - 1).square().sum() / 4; },
            [](const VectorXd& q) -> VectorXd { return q.array() * (q.array().square() - 1); },
            [](const VectorXd& q) -> MatrixXd {
                return MatrixXd((3 * q.array().square() - 1).matrix().asDiagonal());
            }};
}

/// Σ c q - ln q, allowed for q > 0: minimum at 1/c.
Functions barrier(double c) {
    return {[=](const VectorXd& q) {
                return q.minCoeff() > 0 ? (c * q.array() - q.array().log()).sum()
                                        : std::numeric_limits<double>::infinity();
            },
            [=](const VectorXd& q) -> VectorXd { return c - q.array().inverse(); },
            [](const VectorXd& q) -> MatrixXd {
                return MatrixXd(q.array().square().inverse().matrix().asDiagonal());
            }};
}

}  // namespace

TEST_CASE("a quadratic function takes one step") {
    const MatrixXd A = symmetric(12, 1, 100);
    const VectorXd b = VectorXd::LinSpaced(12, -1, 1);
    DensePotential potential(quadratic(A, b));
    VectorXd q = VectorXd::Constant(12, 5);
    NewtonOptions options = within(1e-9);
    options.first_forcing = 0;  // as accurate as the goal asks for
    const NewtonSummary summary = minimize(potential, q, options);
    CHECK(summary.termination == Termination::Converged);
    CHECK(summary.iterations == 1);
    CHECK(summary.residual <= 1e-9);
    CHECK((q - A.ldlt().solve(b)).norm() <= 1e-8);
    CHECK(potential.projections == 0);
}

TEST_CASE("a curved valley is followed to its end") {
    DensePotential potential(valley());
    VectorXd q = Vec3(-1.2, 1, 1);
    const NewtonSummary summary = minimize(potential, q, within(1e-10));
    CHECK(summary.termination == Termination::Converged);
    CHECK((q - Vec3(1, 1, 0)).norm() <= 1e-8);
}

TEST_CASE("where the function is concave the projected Hessian leads to a minimum") {
    // Near the maximum Newton's own direction climbs to it.
    DensePotential potential(double_well());
    VectorXd q = Vec3(0.3, -0.2, 0.9);
    const NewtonSummary summary = minimize(potential, q, within(1e-10));
    CAPTURE(to_string(summary.termination), q.transpose());
    CHECK(summary.termination == Termination::Converged);
    CHECK(potential.projections > 0);
    CHECK((q.cwiseAbs() - Vec3::Ones()).norm() <= 1e-8);
}

TEST_CASE("convergence is faster than linear") {
    // The error after k iterations, from the same start. Forcing by the squared ratio of residuals: order > 1.5.
    std::vector<double> errors;
    for (int k = 1; k <= 12; ++k) {
        DensePotential potential(barrier(2));
        VectorXd q = Vec3(0.2, 0.3, 0.9);
        minimize(potential, q, within(1e-14, k));
        errors.push_back((q - Vec3::Constant(0.5)).norm());
    }
    int seen = 0;
    for (std::size_t k = 0; k + 1 < errors.size(); ++k)
        if (errors[k] < 0.1 && errors[k + 1] > 1e-12) {
            CHECK(std::log(errors[k + 1]) / std::log(errors[k]) > 1.3);
            ++seen;
        }
    CHECK(seen > 0);
    CHECK(errors.back() < 1e-12);
}

TEST_CASE("the line search stays where the function is finite") {
    DensePotential potential(barrier(2));
    VectorXd q = Vec3(10, 4, 0.1);  // the full step from 10 goes to -180
    const NewtonSummary summary = minimize(potential, q, within(1e-10));
    CHECK(summary.termination == Termination::Converged);
    CHECK((q - Vec3::Constant(0.5)).norm() <= 1e-8);
}

TEST_CASE("held components keep their value to the last bit") {
    DensePotential potential(valley());
    potential.held = {0};
    VectorXd q = Vec3(-0.7, 1, 1);
    CHECK(minimize(potential, q, within(1e-10)).termination == Termination::Converged);
    CHECK(q[0] == -0.7);
    CHECK(q[1] == Approx(0.49).epsilon(1e-8));
    CHECK(std::abs(q[2]) <= 1e-9);
}

TEST_CASE("it stops at the tolerance of the scale, and at the noise") {
    // The tolerance is relative to the scale; a scale and a noise that say "small enough" need no step.
    for (const auto& [scale, noise] : {std::pair{1e9, 0.0}, std::pair{1.0, 1e3}}) {
        DensePotential potential(quadratic(symmetric(3, 1, 2), Vec3(1, 2, 3)));
        potential.scale = scale;
        potential.noise = noise;
        VectorXd q = Vec3::Zero();
        const NewtonSummary summary = minimize(potential, q, within(1e-6));
        CHECK(summary.termination == Termination::Converged);
        CHECK(summary.iterations == 0);
        CHECK(q.norm() == 0);
    }
}

TEST_CASE("a gradient against no scale is still brought down") {
    // A body that falls undeformed from rest has no inner forces to measure its residual by.
    DensePotential potential(quadratic(symmetric(3, 1, 2), Vec3(1, 2, 3)));
    potential.scale = 0;
    potential.noise = 1e-14;
    for (const bool line_search : {true, false}) {
        VectorXd q = Vec3::Zero();
        NewtonOptions options = within(1e-6, line_search ? 20 : 1);
        options.line_search = line_search;
        const NewtonSummary summary = minimize(potential, q, options);
        CHECK(summary.termination == Termination::Converged);
        CHECK((q - symmetric(3, 1, 2).ldlt().solve(Vec3(1, 2, 3))).norm() <= 1e-5);
    }
}

TEST_CASE("failures are told apart") {
    const auto termination_of =
        [](const Functions& f, VectorXd q, const NewtonOptions& options) {
            DensePotential potential(f);
            return minimize(potential, q, options).termination;
        };
    CHECK(termination_of(valley(), Vec3(-1.2, 1, 1), within(1e-10, 2))
          == Termination::IterationLimit);
    CHECK(termination_of(barrier(2), Vec3(-1, 1, 1), within(1e-10)) == Termination::NotFinite);
    NewtonOptions few_linear = within(1e-12);
    few_linear.max_linear_iterations = 1;
    CHECK(termination_of(quadratic(symmetric(12, 1, 100), VectorXd::Ones(12)),
                         VectorXd::Zero(12),
                         few_linear)
          == Termination::LinearSolveFailed);
    Functions climbing = double_well();  // a gradient of the wrong sign
    climbing.gradient = [](const VectorXd& q) -> VectorXd {
        return q.array() * (1 - q.array().square());
    };
    CHECK(termination_of(climbing, Vec3(2, 2, 2), within(1e-10))
          == Termination::LineSearchFailed);
    for (const auto t : {Termination::Converged,
                         Termination::IterationLimit,
                         Termination::LineSearchFailed,
                         Termination::LinearSolveFailed,
                         Termination::NotFinite})
        CHECK(!sim::to_string(t).empty());
}
