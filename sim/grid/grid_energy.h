// The seam between energies of velocity gradients and the incremental potential.
#pragma once

#include "sim/base/field.h"

namespace sim {

/// An energy Φ(u) of how the degrees of freedom move in a step, u = dt q (#dofs) [m].
class GridEnergy {
  public:
    virtual ~GridEnergy() = default;

    /// Adds ∂Φ/∂u at u = dt q to `gradient` (#dofs) [N] and returns Φ [J]; +infinity where q is not allowed.
    virtual double add_gradient(const Field& q, double dt, Field& gradient) = 0;

    /// Keeps the Hessian K at u = dt q; `project`: made positive semi-definite.
    virtual void linearize(const Field& q, double dt, bool project) = 0;

    /// product += K u.
    virtual void add_product(const Field& u, Field& product) const = 0;

    /// diagonal += a positive estimate of diag K.
    virtual void add_diagonal(Field& diagonal) const = 0;

    /// Its value at rest is the difference of terms as large [J].
    virtual double scale() const = 0;

    /// Its gradient rounds as if the degrees of freedom were as far away from where they started [m].
    virtual double length() const = 0;
};

}  // namespace sim
