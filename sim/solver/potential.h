// The seam between the solver and the mechanics: a function of the degrees of freedom to be minimised.
#pragma once

#include "sim/base/field.h"

namespace sim {

/// W(q) with its derivatives. Components that are held fixed have inverse_diagonal() = 0; their gradient is ignored.
class Potential {
  public:
    virtual ~Potential() = default;

    /// Sets `gradient` to ∂W/∂q and returns W; +infinity where q is not allowed (the gradient is then undefined).
    virtual double value_and_gradient(const Field& q, Field& gradient) = 0;

    /// Keeps the Hessian at q, that of the last value_and_gradient(), for hessian_product() and inverse_diagonal();
    /// `project`: made positive semi-definite.
    virtual void linearize(const Field& q, bool project) = 0;

    /// product = A p; returns pᵀ A p.
    virtual double hessian_product(const Field& p, Field& product) = 0;

    /// One over a positive estimate of A's diagonal, zero for components that are held fixed.
    virtual const Field& inverse_diagonal() const = 0;

    /// Size of the terms that the gradient at the last value_and_gradient() is the sum of, in the norm
    /// |g| = sqrt(Σ g² inverse_diagonal): what a residual is to be small against.
    virtual double gradient_scale() const = 0;

    /// Rounding of the gradient in the same norm: no residual can be brought below it.
    virtual double gradient_noise() const = 0;

    /// Rounding of the value, beside what its own size brings: no decrease can be seen below it.
    virtual double value_noise() const = 0;
};

/// sqrt(Σ g_i² d_i), summed in fixed chunks.
double scaled_norm(const Field& g, const Field& d);

}  // namespace sim
