// What the solver asks of the elastic energy of one body, whatever the quadrature.
#pragma once

#include "sim/base/field.h"
#include "sim/lattice/lattice.h"
#include "sim/scene.h"

#include <memory>

namespace sim {

/// All fields are indexed by the body's corners. Every call gives the same result for any number of threads.
class ElasticEnergy {
  public:
    virtual ~ElasticEnergy() = default;

    /// Sets `gradient` (#C) to ∂E/∂x [N] and returns E [J]; +infinity where a state is forbidden, the gradient then has
    /// no meaning.
    virtual double energy_and_gradient(const Vec3p* x, Vec3p* gradient) = 0;

    /// Keeps K = ∂²E/∂x² at x for product() and diagonal(); `project`: made positive semi-definite.
    virtual void linearize(const Vec3p* x, bool project) = 0;

    /// product = K u.   [N]
    virtual void product(const Vec3p* u, Vec3p* product) = 0;

    /// A positive estimate of K's diagonal.   [N/m]
    virtual void diagonal(Vec3p* diagonal) = 0;

    struct SmallestJ {
        double J = 0;
        int domain = -1;
    };

    /// The smallest det F at any quadrature point.
    virtual SmallestJ smallest_J(const Vec3p* x) const = 0;
};

/// The energy of a body by SolverOptions::quadrature.
std::unique_ptr<ElasticEnergy> make_elastic_energy(const Lattice& lattice,
                                                   const Body& body,
                                                   Quadrature quadrature);

}  // namespace sim
