// Conjugate gradients with the diagonal as preconditioner.
#pragma once

#include "sim/solver/potential.h"

namespace sim {

struct LinearSummary {
    int iterations = 0;
    bool converged = false;
    // A direction with p·A p <= 0 was met: A is not positive definite.
    bool negative_curvature = false;
};

/// Buffers of the iteration, kept by the caller between solves.
struct LinearScratch {
    Field residual, direction, product;
};

/// Solves A d = -g from d = 0 until |A d + g| <= tolerance |g| in the norm of scaled_norm(). On negative curvature it
/// stops with the best d so far.
LinearSummary solve_linear(Potential& potential,
                           const Field& g,
                           double tolerance,
                           int max_iterations,
                           Field& d,
                           LinearScratch& scratch);

}  // namespace sim
