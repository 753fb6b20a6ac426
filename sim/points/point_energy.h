// The elastic energy of a body of material points, as a function of how the grid moves them.
#pragma once

#include "sim/grid/corner_map.h"
#include "sim/grid/grid_energy.h"
#include "sim/points/material_points.h"
#include "sim/points/point_laws.h"

#include <vector>

namespace sim {

/// Φ(dt q) = Σ_p V_p Ψ((1 + dt ∇v_p) F_p),  ∇v_p = Σ_i v_i ∂w_ip/∂x with the stencils of the start of the step, so
/// ∂Φ/∂u_i = Σ_p V_p P F_pᵀ ∂w_ip/∂x [SSC13 §6]. The same for any number of threads.
class PointEnergy : public GridEnergy {
  public:
    /// The points are the corners from `first_corner` of body `body` of the map; `map` and `points` outlive the energy.
    PointEnergy(const CornerMap& map,
                int body,
                int first_corner,
                double cell_size,
                const MaterialPoints& points);

    /// Takes F of the start of the step, and the moduli that snow has by then.
    void begin_step(const PointState& state);

    double add_gradient(const Field& q, double dt, Field& gradient) override;
    void linearize(const Field& q, double dt, bool project) override;
    void add_product(const Field& u, Field& product) const override;
    void add_diagonal(Field& diagonal) const override;

    double scale() const override { return scale_; }

    double length() const override { return cell_size_; }

    /// Adds ∂Φ/∂u at the start of the step, where nothing has moved, to `gradient` (#dofs) [N].
    void add_start_gradient(Field& gradient);

    /// As add_gradient() where a drift ends for good: points come to x = x_n + T way, snow yields there before stresses are
    /// taken, and Φ is that of what is left.   way: of the nodes since the step began at x_n (#dofs); x_n, x (#C) [m]
    double end_drift(const Field& way, const Field& x_n, Field& x, Field& gradient);

    /// Moves F by the velocities of the step, and lets snow yield.
    void advance(const Field& q, double dt);

    /// What points remember from now on, after end_drift() or advance().
    void accept(PointState& state);

    /// A bound of the frequencies w that the grid can swing with, from moduli at rest and today's hardening: of one point's
    /// stiffness over the mass that it lends to its nodes,
    ///   w² <= (3λ+2μ)/rho max Σ_a w'_a²/w_a / h²,   the sum at most 6 and 3.04 for quadratic and cubic splines
    /// (Irons: no assembly swings faster than its fastest part). Infinite for linear ones, as the sum is.   [rad/s]
    double highest_frequency(Kernel kernel) const;

    /// Σ_p V_p Ψ(F_p) of a state [J].
    double energy(const PointState& state) const;

    struct SmallestJ {
        double J = 0;
        int point = -1;
    };

    /// Of the elastic F where all was last taken to, or the first that is no number.
    SmallestJ smallest_trial_J() const;

  private:
    PointsOfSlaves slaves() const;
    void harden(int p);
    void yield(const CornerMap::Slaves& at);
    void yield(const int* point, int n);
    double sum_of_energies() const;

    const CornerMap& map_;
    int body_, first_corner_;
    double cell_size_;
    const MaterialPoints& points_;
    std::vector<PointLaw> law_;          // (#P) now
    unsigned models_ = 0;                // a bit for each of their models
    std::vector<StretchLimits> limits_;  // (#regions) where any is snow, else empty
    std::vector<double> J_of_moduli_;  // (#P) J_P that they are of: few points yield in a step
    double scale_ = 0;
    // Of the start of the step, from where its motion leads to F_next_: what yields meanwhile yields there, too.
    PointState start_;
    std::vector<Matrix3<double>> F_next_;    // (#P) where all was last taken to
    std::vector<double> chunk_energy_;       // (#chunks)
    std::vector<PointStiffness> stiffness_;  // (#batches)
    std::vector<Lanes> weight_;              // (#batches) [J]
};

}  // namespace sim
