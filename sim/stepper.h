// A step in time, and an equilibrium: the method itself.
#pragma once

#include "sim/assembly.h"
#include "sim/contact/grid_contact.h"
#include "sim/contact/grid_hold.h"
#include "sim/contact/surface_contact.h"
#include "sim/incremental_potential.h"
#include "sim/pinned_nodes.h"
#include "sim/pinning.h"
#include "sim/points/point_energy.h"
#include "sim/rigid_motion.h"
#include "sim/solver/newton.h"
#include "sim/state.h"

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace sim {

/// Every step sees the state as  x_{n+1} = x^ + dt^ v_{n+1},  v_{n+1} = v^ + dt^ a_{n+1}, carries v^
/// to the degrees of freedom, solves there, and brings the change back to the corners.
class Stepper {
  public:
    Stepper(const Scene& scene, Assembly& assembly);

    /// Steps by solver.steps until state.time is `end`, in steps no longer than dt, nor than failures and stability
    /// allow: a step that fails is halved, and grows back slowly. Explicit steps are longer while no surfaces touch: kicks
    /// and drifts, no longer than that, are repeated under one map T as long as no slaved corner goes far in the cells of
    /// the grid; their length changes only where it must, or where much longer ones are stable. `watch` is told how far it
    /// has come, after each step and on the way of each solve, and may throw. Throws Error(Diverged) where halving does not
    /// help.
    void advance(State& state,
                 double end,
                 double dt,
                 const std::function<void(double time)>& watch);

    /// Equilibrium of the loads at `time`, reached from `state` by moving the pins there; velocities become zero.
    /// Where the way is too long for one solve it is halved. Throws Error(Diverged).
    void equilibrium(State& state,
                     double time,
                     const std::function<void(double time)>& watch = {});

    /// Recomputes degrees of freedom and pin reactions for a state that no step has led to (start, restart).
    void refresh(State& state);

    /// Before refresh() of a state that a checkpoint has kept: the map that its steps went by.
    void restore_map(const State& state);

    int newton_iterations = 0, cg_iterations = 0, steps = 0;  // totals

    /// Gives points, and corners that APIC moves, what they remember of a body that starts undeformed.
    void start(State& state);

    /// What went wrong in the steps that a shorter one replaced, in words.
    std::vector<std::string> failures;

    /// Mass on the degrees of freedom of the last step [kg], and the forces of the pins on corners (#C) [N].
    double mass_on_dofs() const;

    /// What bodies have beyond the motion of mass at their corners.
    struct BeyondCorners {
        double energy = 0;               // kinetic [J]
        Vec3 angular_momentum{0, 0, 0};  // [kg m²/s]
    };

    /// Σ_c m/2 tr(C D Cᵀ) and Σ_c m Σ_j e_j × (C D)_j, of what APIC remembers of how the velocity changes around corners that
    /// are slaved, by the mean of D over all places: a rotation keeps both while corners pass through their cells.
    BeyondCorners affine_motion(const State& state) const;

    /// Of nodes that move along, where the mass of slaved corners is lumped.
    BeyondCorners node_motion(const State& state) const;

    const Field& reaction() const { return reaction_; }

    const ColliderContact& colliders() const { return colliders_; }

    /// Of bodies against each other, to measure how far they are apart, also where contact is on the grid.
    SurfaceContact& surfaces() { return measured_ ? *measured_ : surfaces_; }

    const Prescribed& prescribed() const { return prescribed_; }

    /// What pins do to a node of a body of points.
    struct NodeReaction {
        HeldBy holder = held_by_none;
        Vec3 at{0, 0, 0}, force{0, 0, 0};  // [m], [N]
    };

    const std::vector<NodeReaction>& node_reactions() const { return node_reactions_; }

    /// The energy of a body of points, null for others.
    const PointEnergy* points(int body) const { return points_[body].get(); }

    const IncrementalPotential& potential() const { return potential_; }

  private:
    // step_control.cpp
    double longest_of_drifts(const State& state, double drift, double dt) const;
    void go_on(State& state, double end, double dt);
    [[noreturn]] void refuse_steps(const State& state, double n, double length) const;
    void halve(State& state, double failed, double stable);
    bool try_step(State& state, double dt);

    // stepper.cpp: what all steps share
    enum class Scheme { BackwardEuler, Bdf2 };
    void begin_step(State& state, double dt, Scheme scheme);
    void begin_forces(const State& state);
    void make_map(State& state, const Field& x);
    void choose_free_corners(int body, const Field& x);
    void start_scheme(const State& state, double dt, Scheme scheme);

    struct Motion {
        Vec3p dx{}, dv{};
    };

    Motion motion_before(const State& state, double dt, int c) const;
    void expect_free_motion();
    void prescribe_dofs(const State& state, const Field& x_n, double drift, double dt);
    bool is_held(int body) const;
    void end_on_targets();
    void commit(State& state, double dt);
    void end_step(State& state, double dt);
    void measure_speed(const State& state);

    // moving_grid.cpp
    void keep_map(State& state, const Field& x_hat);
    bool has_other_pins(int body, const MovingGrid& grid) const;
    void renew_map(State& state);
    void measure_frequencies(const std::vector<char>& changes);
    void place_nodes(const State& state, const Field& x_hat);
    void add_lifted(const State& state, const Field& end, const Field& start, Field& nodes);
    void end_grid(State& state);

    // transfer.cpp
    // Of corners at x that move with v, under the map there; `inner`: their gradient, if that goes over as well.
    void transfer_to_nodes(const State& state,
                           const Field& x,
                           const Field& v,
                           const Field* inner);
    // Of that the masses of nodes and their velocities q_n_.
    void lift(const State& state, const Field& x, const Field& v);
    void transfer_forces(const Field* inner);
    double share_kept(double dt) const;

    /// What the end of a step takes over from its start.
    struct Memory {
        // At its start (0) or its end (1): where the old momentum turns the body.
        double way = 0;
        double undamped = 1;  // what damping leaves of velocities
        double unseen = 1;    // what stays of the part of them that nodes do not see (FLIP)
    };

    // Angular momentum by forces, about the centres of the bodies at the start.   [kg m²/s]
    std::vector<Vec3p> gained_by_nodes(const Memory& memory) const;
    // What turns corners that have come from x_n so that the body gains an angular momentum.   [rad/s]
    Vec3p spin_for(const Vec3p& missing, int body, const Field& x_n) const;
    // From v = T (q - unseen q_n) of slaves to what they have at the end, FLIP's T q + unseen (v_before - T q_n) and their
    // share of the angular momentum that nodes have gained, unless the body is held.
    void return_to_slaves(const Field& x_n,
                          const Field& v_before,
                          const Memory& memory,
                          const std::vector<Vec3p>& gained,
                          Field& v) const;

    // step_contact.cpp: contact after the velocities are known
    std::vector<GridPair> pairs_on_grid() const;
    void begin_contact(const Field& x);
    // Whether bodies meet; moved_ follows at grid_contact_->corners() alone.
    bool restrain_on_grid(const Field& x, double dt);
    void drift(const Field& x_n, double length);

    // point_step.cpp: what points and APIC add to a step
    std::vector<GridEnergy*> make_points();
    void add_affine_momentum(const State& state);
    void commit_affine(State& state, const Field& q) const;
    // From force_on(k-th pinned node, its degree of freedom).   [N]
    void set_node_reactions(const std::function<Vec3p(int, int)>& force_on);
    void add_start_gradient(Field& gradient);
    // Moves points from where the step began; returns their energy there.
    double end_drift(const Field& x_n, double length);
    void add_at_pinned_nodes(double share);
    double seen_frequency_of_points();
    double relative_limit(const State& state) const;

    // implicit_step.cpp
    bool try_implicit(State& state, double dt);
    bool try_bdf2(State& state, double dt);
    bool solve_step(State& state, double dt, Scheme scheme);
    // Solves again until is_settled(pass), from 1.
    bool minimize_with_contact(const NewtonOptions& options,
                               const std::function<bool(int)>& is_settled);
    bool are_surfaces_settled(int pass, int most_passes);
    bool is_contact_settled(const Field& x_n, int pass);
    bool is_grid_settled(const Field& x_n);
    void end_implicit(State& state, double dt);
    void keep_inner_force(State& state);
    void guess(const State& state, double dt);
    bool start_from_rest();
    void move_corners();
    void balance_momentum();
    void set_reactions();

    // explicit_step.cpp
    void measure_stiffening(const Field& x);
    // Whether bodies are too stiff now, at the end of a step, for drifts that long.
    bool has_stiffened(double drift);
    double stable_limit(std::size_t body) const;
    double stable_limit() const;
    double limit_of_way(double cells) const;
    double limit_of_slaves(const Field& v, double cells) const;
    bool try_explicit(State& state, double dt);
    void first_kick(const State& state);
    bool take_drifts(const State& state, double length);
    bool take_drift(const State& state, int number, double length);
    bool drift_with_contact(const State& state, const Field& x, int number, double length);
    // Of any corner in a drift, at most.   [m]
    double longest_way(double length) const;
    void kick_between_drifts();
    void gather_forces_at_nodes(const Field& gradient);
    void hold_prescribed();
    // Of bodies of points, or of the others.
    bool has_kept_way(const Field& x, bool of_points) const;
    bool is_clear_of_surfaces(const State& state, double dt);
    // Returns how deep a corner would have got in, in domain edges.
    double restrain_by_colliders(const Field& x, double length);
    bool restrain_by_surfaces(const State& state, double dt);
    double second_kick(const Field& gradient_before);
    /// w² = |M⁻¹ dg|²_M / dx·dg, with dg the change of the forces over dx: of the modes in dx the fastest weigh most. The
    /// sums are |M⁻¹ dg|²_M, dx·dg and |dx|²_M; 0 where they are noise.   [1/s]
    double frequency_of(const Vec3p& sums) const;
    void kick_nodes(const State& state, double dt);
    void set_explicit_reactions(const State& state, double dt);

    // equilibrium.cpp
    bool try_equilibrium(State& state,
                         double time_begin,
                         double time_end,
                         NewtonSummary& summary);

    static constexpr double cells_per_step = 0.3;  // that a corner may pass in an explicit one

    const Scene& scene_;
    Assembly& assembly_;
    std::vector<CornerMap::BodyRange> ranges_;
    CornerMap map_;
    ColliderContact colliders_;
    PairFriction friction_;
    SurfaceContact surfaces_;                           // empty where contact is on the grid
    std::optional<SurfaceContact> measured_;            // there, to measure penetration only
    GridHold grid_hold_;                                // of this step, implicit
    std::vector<std::unique_ptr<PointEnergy>> points_;  // (#bodies)
    bool has_points_ = false;
    std::vector<int> bodies_of_domains_;
    IncrementalPotential potential_;
    NewtonScratch scratch_;
    NewtonSummary summary_;        // of the last solve
    std::function<void()> watch_;  // of the call of advance() or equilibrium()
    Prescribed prescribed_;
    std::vector<char> free_;            // (#C)
    bool moves_grid_ = false;           // whether the grid is a MovingGrid
    Field node_v_hat_;                  // (#nodes) v^ of its nodes [m/s]
    std::vector<double> inverse_mass_;  // (#dofs) 0 where there is none [1/kg]
    double dt_hat_ = 0;                 // dt^ of the scheme [s]
    double history_ = 0;                // share of the last step's change in x^ and v^
    Field v_hat_;                       // v^ of the scheme (#C) [m/s]
    std::vector<double> dof_mass_;      // (#dofs) [kg]
    Field q_n_, q_;                     // (#dofs) [m/s]
    // (#dofs) Tᵀ f; explicit steps: of domains with their stress, and at nodes alone   [N]
    Field node_force_;
    std::vector<RigidMotion> rigid_;  // (#bodies) before the step, of those with slaves
    std::vector<Vec3p> shift_;        // (#bodies) what balances momentum in moved_ [m/s]
    Field q_moved_;  // (#dofs) what moved_ comes from, but for a rigid shift [m/s]

    /// A degree of freedom with prescribed components, and their velocity [m/s].
    struct PrescribedDof {
        int dof = 0;
        Vec3p velocity{};
    };

    std::vector<PrescribedDof> held_;
    std::vector<PinnedNode> pinned_nodes_;
    std::vector<NodeReaction> node_reactions_;
    // Of points in explicit steps, where a drift ends and where it began (#dofs) [N]
    Field grid_gradient_, grid_gradient_before_;
    Field way_;                      // of nodes since the step began (#dofs) [m]
    Field moved_;                    // (#C) velocity that moves the corners in this step [m/s]
    Field corner_;                   // (#C) scratch of one function and what it calls
    Field reaction_;                 // (#C) of pins [N]
    Field x_end_;                    // (#C) where they end [m]
    Field v_end_;                    // (#C) and how fast, of explicit steps [m/s]
    std::vector<double> speed_;      // (#bodies) of the fastest corner [m/s]
    Field gradient_, end_gradient_;  // of explicit steps, at the start and the end (#C) [N]
    // (#bodies) That explicit steps have to follow at rest, of bodies of domains: under a map that stays, what it lets through.
    std::vector<double> highest_frequency_;
    // (#bodies) ElasticEnergy::stiffening() at the last measure.
    std::vector<double> stiffening_;
    // Drifts: since then, and until the next.
    int drifts_since_measure_ = 0, measure_after_ = 1;
    int n_drifts_ = 1;                 // of the step, if it is explicit
    double quiet_drifts_ = 0;          // where it ends
    Field x_drift_, gradient_before_;  // where its last drift begins, of several (#C) [m], [N]
    Field inner_gradient_;  // Σ over what lies between its drifts, at prescribed corners [N]
    Field inner_at_nodes_;  // Σ over its drifts, at pinned nodes [N]
    // Of a step, under its map.
    std::optional<Impulses> impulses_;
    std::optional<GridContact> grid_contact_;
};

}  // namespace sim
