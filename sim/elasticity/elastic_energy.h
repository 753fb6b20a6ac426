// What the solver asks of the elastic energy of one body, whatever the quadrature.
#pragma once

#include "sim/base/field.h"
#include "sim/base/volume_ratio.h"
#include "sim/lattice/lattice.h"
#include "sim/scene.h"

#include <memory>
#include <vector>

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

    /// How much larger c² of the fastest wave in any domain is at x than at rest, at centres of domains, 1 at least: about
    /// what the square of the highest frequency grows by. A domain that is forbidden, or whose x is not finite, counts for
    /// nothing.
    virtual double stiffening(const Vec3p* x) const = 0;

    struct SmallestJ {
        double J = 0;
        int domain = -1;
    };

    /// The smallest det F at any quadrature point, or the first that is no number.
    virtual SmallestJ smallest_J(const Vec3p* x) const = 0;
};

/// (#D) What turns rho c² of a wave in a domain into c² over that of the body's fastest wave at rest.   [1/Pa]
std::vector<double> wave_compliances(const Lattice& lattice);

/// The energy of a body by SolverOptions::quadrature.
std::unique_ptr<ElasticEnergy> make_elastic_energy(const Lattice& lattice,
                                                   const Body& body,
                                                   Quadrature quadrature);

}  // namespace sim
