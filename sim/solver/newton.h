// Newton's method with backtracking line search on a potential.
#pragma once

#include "sim/solver/conjugate_gradients.h"

#include <functional>
#include <string>

namespace sim {

struct NewtonOptions {
    // Stop when |gradient| <= max(tolerance * gradient_scale(), gradient_noise()).
    double tolerance = 1e-4;
    int max_iterations = 50;  // >= 1
    // Relative tolerance of the first linear solve; 0: what the goal asks for.
    double first_forcing = 0;
    int max_linear_iterations = 20000;
    bool line_search = true;  // false: one full step, converged if it halves the gradient
    std::function<void()> before_iteration;  // where not empty; what it throws ends the call
};

enum class Termination {
    Converged,
    IterationLimit,
    LineSearchFailed,
    LinearSolveFailed,
    NotFinite,
    Unstable
};

struct NewtonSummary {
    Termination termination = Termination::NotFinite;
    int iterations = 0, linear_iterations = 0;
    double residual = 0;  // |gradient| / gradient_scale() at the end
};

/// In words, for a diagnosis.
std::string to_string(Termination termination);

/// Buffers kept by the caller between solves.
struct NewtonScratch {
    Field gradient, step, trial, trial_gradient;
    LinearScratch linear;
};

/// Minimises W from q, which must be allowed (W finite). The Hessian is used as it is, and made positive semi-definite
/// for the rest of the call where conjugate gradients meet negative curvature or the line search finds no descent.
/// The linear solves are inexact: no more accurate than the goal asks for, after the first no more than to a tenth.
/// On return q holds the best iterate; the caller decides what a failure means.
NewtonSummary minimize(Potential& potential,
                       const NewtonOptions& options,
                       Field& q,
                       NewtonScratch& scratch);

}  // namespace sim
