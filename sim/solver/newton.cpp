#include "sim/solver/newton.h"

#include "sim/base/parallel.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int chunk = 8192;
constexpr double armijo = 1e-4;  // share of the predicted decrease that a step must bring
// Of the gradient, that a step without a line search may leave.
constexpr double single_step = 0.5;
constexpr double value_rounding = 1e-13;  // of W, relative
constexpr int max_halvings = 30;

double slope(const Field& gradient, const Field& step) {
    return sum_chunks(static_cast<int>(gradient.size()), chunk, [&](int begin, int end) {
        double sum = 0;
        for (int i = begin; i < end; ++i)
            sum += dot(gradient[i], step[i]);
        return sum;
    });
}

/// How accurate a linear solve is worth being (Eisenstat and Walker's idea, bounded by the goal).
double forcing(
    const NewtonOptions& options, int iteration, double goal, double norm, double norm_before) {
    if (!options.line_search)
        return options.tolerance;
    const double enough = 0.3 * goal / norm;  // < 0.3, as the norm is above the goal
    if (iteration == 0)
        return std::clamp(options.first_forcing, enough, 0.3);
    const double ratio = norm / norm_before;
    return std::max(enough, std::min(0.1, ratio * ratio));
}

/// Backtracks from the full step until W decreases enough. Returns the step length, 0 where none does.
double search_line(
    Potential& potential, const Field& q, double value, NewtonScratch& s, double& trial_value) {
    const int n = static_cast<int>(q.size());
    const double descent = slope(s.gradient, s.step);
    s.trial.resize(n);
    const double noise = value_rounding * std::abs(value) + potential.value_noise();
    double length = 1;
    for (int k = 0; k < max_halvings; ++k, length /= 2) {
        for_chunks(n, chunk, [&](int begin, int end) {
            for (int i = begin; i < end; ++i)
                s.trial[i] = q[i] + length * s.step[i];
        });
        trial_value = potential.value_and_gradient(s.trial, s.trial_gradient);
        if (trial_value <= value + armijo * length * descent + noise)
            return length;
    }
    return 0;
}

double relative(double norm, double scale) {
    return scale > 0 ? norm / scale : norm;
}

/// Newton's direction s.step from the system linearised at q, projected from then on where it is indefinite. Whether the
/// linear solve has converged.
bool find_direction(Potential& potential,
                    const NewtonOptions& options,
                    double tolerance,
                    const Field& q,
                    bool& project,
                    NewtonScratch& s,
                    NewtonSummary& summary) {
    const auto solve = [&] {
        const LinearSummary linear = solve_linear(
            potential, s.gradient, tolerance, options.max_linear_iterations, s.step, s.linear);
        summary.linear_iterations += linear.iterations;
        return linear;
    };
    LinearSummary linear = solve();
    if (linear.negative_curvature && !project) {
        project = true;
        potential.linearize(q, project);
        linear = solve();
    }
    return linear.converged;
}

/// Adds the direction to q whatever W does, and tells what it has left of a gradient of that norm.
void take_whole_step(Potential& potential,
                     double norm,
                     double scale,
                     Field& q,
                     NewtonScratch& s,
                     NewtonSummary& summary) {
    for (std::size_t i = 0; i < q.size(); ++i)
        q[i] += s.step[i];
    ++summary.iterations;
    const double value = potential.value_and_gradient(q, s.gradient);
    const double left = scaled_norm(s.gradient, potential.inverse_diagonal());
    summary.residual = relative(left, std::max(scale, potential.gradient_scale()));
    summary.termination = !std::isfinite(value)        ? Termination::NotFinite
                          : left <= single_step * norm ? Termination::Converged
                                                       : Termination::IterationLimit;
}

}  // namespace

std::string to_string(Termination termination) {
    switch (termination) {
        case Termination::Converged:
            return "converged";
        case Termination::IterationLimit:
            return "Newton's method did not converge within its iterations";
        case Termination::LineSearchFailed:
            return "no step along Newton's direction lowers the energy";
        case Termination::LinearSolveFailed:
            return "conjugate gradients did not converge within their iterations";
        case Termination::NotFinite:
            return "the energy is not finite (a domain is inverted)";
        case Termination::Unstable:
            return "the motion is faster than an explicit step can follow";
    }
    return {};
}

NewtonSummary minimize(Potential& potential,
                       const NewtonOptions& options,
                       Field& q,
                       NewtonScratch& s) {
    NewtonSummary summary;
    const auto end = [&](Termination termination) {
        summary.termination = termination;
        return summary;
    };
    s.gradient.resize(q.size());
    s.trial_gradient.resize(q.size());
    double value = potential.value_and_gradient(q, s.gradient);
    if (!std::isfinite(value))
        return summary;

    // Norms are taken with the last linearisation: the first one is needed before anything can be judged.
    bool project = false, linearized = true;
    potential.linearize(q, project);
    double scale = 0;
    double norm_before = 0;
    for (;; ++summary.iterations) {
        // The gradient is small enough? Forces may appear on the way, as contact does: the largest met is the scale.
        scale = std::max(scale, potential.gradient_scale());
        const double goal = std::max(options.tolerance * scale, potential.gradient_noise());
        const double norm = scaled_norm(s.gradient, potential.inverse_diagonal());
        summary.residual = relative(norm, scale);
        if (!(norm > goal))
            return end(std::isfinite(norm) ? Termination::Converged : Termination::NotFinite);
        if (summary.iterations == options.max_iterations)
            return end(Termination::IterationLimit);
        if (options.before_iteration)
            options.before_iteration();

        if (!linearized)
            potential.linearize(q, project);
        linearized = false;
        const double tolerance = forcing(options, summary.iterations, goal, norm, norm_before);
        if (!find_direction(potential, options, tolerance, q, project, s, summary))
            return end(Termination::LinearSolveFailed);
        if (!options.line_search) {
            take_whole_step(potential, norm, scale, q, s, summary);
            return summary;
        }
        double trial_value = 0;
        const double length = search_line(potential, q, value, s, trial_value);
        if (length == 0) {
            if (project)
                return end(Termination::LineSearchFailed);
            project = true;
            value = potential.value_and_gradient(q, s.gradient);
            continue;
        }
        value = trial_value;
        norm_before = norm;
        std::swap(q, s.trial);
        std::swap(s.gradient, s.trial_gradient);
    }
}

}  // namespace sim
