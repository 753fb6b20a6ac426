// The seam between contact and the incremental potential.
#pragma once

#include "sim/base/field.h"

namespace sim {

/// An energy of all corners that is only felt where things touch.
class ContactEnergy {
  public:
    virtual ~ContactEnergy() = default;

    /// Adds ∂/∂x to `gradient` (#C) [N] and returns the energy at x [J].
    virtual double add_gradient(const Field& x, Field& gradient) const = 0;

    /// Keeps a positive semi-definite Hessian H at x.
    virtual void linearize(const Field& x) = 0;

    /// product += H u.
    virtual void add_product(const Field& u, Field& product) const = 0;

    /// diagonal += diag H.
    virtual void add_diagonal(Field& diagonal) const = 0;
};

}  // namespace sim
