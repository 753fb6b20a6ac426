// The incremental potential of one step: what a step of every method minimises.
#pragma once

#include "sim/contact/contact_energy.h"
#include "sim/elasticity/elastic_energy.h"
#include "sim/grid/corner_map.h"
#include "sim/grid/grid_energy.h"
#include "sim/solver/potential.h"

#include <vector>

namespace sim {

/// Backward Euler in the degrees of freedom q (velocities),
///
///   W(q) = 1/2 (q - q~)ᵀ M (q - q~) + Φ(x_n + dt T q),      A = M + dt² Tᵀ K T
///
/// with Φ = elastic + hourglass + contact energies of corners, and energies of the grid's motion, M lumped on q, and q~ the
/// velocity after transfer, external forces and damping. Statics is the same with M = 0, dt = 1 (q is then a displacement)
/// and the external forces in Φ: W(u) = Φ(x_n + T u) - f·(x_n + T u).
class IncrementalPotential : public Potential {
  public:
    /// The bodies' energies of corners, null for bodies of points, and their ranges in the field of all corners.
    struct ElasticBody {
        ElasticEnergy* elasticity = nullptr;
        int begin = 0, end = 0;
        // Σ V (lambda + 2 mu): its energy at rest is the difference of terms as large [J]
        double energy_scale = 0;
    };

    IncrementalPotential(const CornerMap& map,
                         std::vector<ElasticBody> bodies,
                         std::vector<ContactEnergy*> contacts,
                         std::vector<GridEnergy*> grids)
        : map_(map),
          bodies_(std::move(bodies)),
          contacts_(std::move(contacts)),
          grids_(std::move(grids)) {}

    /// What a step starts from. `mass`, `q_tilde` and `is_free` are indexed by q; `x_n` and `static_force` by corner
    /// (the latter empty in dynamics). is_free holds 1 in free components and 0 in prescribed ones.
    struct Step {
        double dt = 0;
        std::vector<double> mass;  // [kg]
        Field x_n, q_tilde, is_free, static_force;
    };

    Step& step() { return step_; }

    /// The bodies' energies at corners x, and their gradient (#C) [N]; of bodies of points none.   [J]
    double elastic_gradient(const Field& x, Field& gradient);

    double value_and_gradient(const Field& q, Field& gradient) override;
    void linearize(const Field& q, bool project) override;
    double hessian_product(const Field& p, Field& product) override;

    const Field& inverse_diagonal() const override { return inverse_diagonal_; }

    double gradient_scale() const override;

    double gradient_noise() const override { return noise_; }

    double value_noise() const override;

    /// Corner positions of the last q evaluated.
    const Field& positions() const { return x_; }

    /// ∂Φ/∂x (#C) at the last q evaluated [N].
    const Field& corner_gradient() const { return corner_gradient_; }

    /// dt Tᵀ ∂Φ/∂x (#dofs) there, energies of the grid included [N s].
    const Field& inner_part() const { return inner_part_; }

  private:
    template <class Act>
    void for_elastic(Field& sums, const Act& act);

    const CornerMap& map_;
    std::vector<ElasticBody> bodies_;
    std::vector<ContactEnergy*> contacts_;
    std::vector<GridEnergy*> grids_;
    Step step_;
    Field x_, corner_gradient_, corner_product_, corner_diagonal_, inner_part_,
        inverse_diagonal_, grid_diagonal_;
    double noise_ = 0;
};

}  // namespace sim
