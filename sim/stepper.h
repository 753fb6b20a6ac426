// A step in time, and an equilibrium: the method itself.
#pragma once

#include "sim/contact/grid_contact.h"
#include "sim/incremental_potential.h"
#include "sim/pinning.h"
#include "sim/solver/newton.h"

#include <vector>

namespace sim {

/// All that changes, and that later steps depend on. Indexed by corner.
struct State {
    double time = 0;  // [s]
    Field x, v;       // positions [m], velocities [m/s]
    Field
        inner_impulse;  // velocity that inner forces and contact gave in the last step, a guess for the next [m/s]
    double last_dt = 0;  // of that step [s]
};

/// v(x) = velocity + spin × (x - centre): the rigid motion with a body's linear and angular momentum.
struct RigidMotion {
    Vec3p centre{}, velocity{}, spin{};

    Vec3p at(const Vec3p& x) const {
        const Vec3p r = x - centre;
        return velocity
               + Vec3p{spin[1] * r[2] - spin[2] * r[1],
                       spin[2] * r[0] - spin[0] * r[2],
                       spin[0] * r[1] - spin[1] * r[0],
                       0};
    }
};

class Stepper {
  public:
    Stepper(const Scene& scene, Assembly& assembly);

    /// One step of solver.steps from state.time to state.time + dt. Throws Error(Diverged).
    void step(State& state, double dt);

    /// Equilibrium of the loads at `time`, reached from `state` by moving the pins there; velocities become zero.
    /// Where the way is too long for one solve it is halved. Throws Error(Diverged).
    void equilibrium(State& state, double time);

    /// Recomputes degrees of freedom and pin reactions for a state that no step has led to (start, restart).
    void refresh(const State& state);

    int newton_iterations = 0, cg_iterations = 0, steps = 0;  // totals

    /// Mass on the degrees of freedom of the last step [kg], and the forces of the pins on corners (#C) [N].
    double mass_on_dofs() const;

    const Field& reaction() const { return reaction_; }

    const Prescribed& prescribed() const { return prescribed_; }

    const IncrementalPotential& potential() const { return potential_; }

  private:
    void choose_free_corners(const Field& x);
    void transfer(const State& state, double dt);
    std::vector<RigidMotion> rigid_motions(const State& state) const;
    void guess(const State& state, double dt);
    void move(State& state, double dt);
    void balance_momentum(const State& state, double dt, Field& u) const;
    void see_on_grid(const Field& u, Field& contact_velocity) const;
    void set_reactions(const State& state, double dt);
    bool try_equilibrium(State& state,
                         double time_begin,
                         double time_end,
                         NewtonSummary& summary);
    [[noreturn]] void fail(const State& state, double dt, const NewtonSummary& summary);

    const Scene& scene_;
    Assembly& assembly_;
    std::vector<CornerMap::BodyRange> ranges_;
    CornerMap map_;
    ColliderContact colliders_;
    IncrementalPotential potential_;
    NewtonScratch scratch_;
    Prescribed prescribed_;
    std::vector<char> free_;            // (#C)
    std::vector<double> inverse_mass_;  // (#dofs) 0 where there is none [1/kg]
    Field dof_mass_, q_n_, q_, corner_, reaction_;
};

}  // namespace sim
