// Implicit steps: backward Euler, BDF2, and the paper's single linearised solve.
#include "sim/stepper.h"

#include <algorithm>

namespace sim {

namespace {

constexpr double dynamic_tolerance = 1e-3;  // of the inner forces of the step
constexpr double semi_implicit_forcing = 1e-6;
constexpr double short_step = 10;  // w dt, whose square times dynamic_tolerance is 0.1
constexpr int contact_passes = 6;  // of surfaces
constexpr int grid_passes = 20;
constexpr double depth_tolerance = 2e-3;  // of a linearised depth, in domain edges

}  // namespace

bool Stepper::try_implicit(State& state, double dt) {
    if (!solve_step(state, dt, Scheme::BackwardEuler))
        return false;
    end_implicit(state, dt);
    return true;
}

bool Stepper::try_bdf2(State& state, double dt) {
    // BDF2 takes the motion before as smooth. Where something begins or ceases to touch it is not: the velocity jumps, and
    // to continue the jump would create energy. Such a step is one of backward Euler, as is the one after it; and every one in
    // which bodies meet on the grid.
    const bool is_smooth = state.last_dt == 0 || !state.x_before.empty();
    bool solved = solve_step(state, dt, is_smooth ? Scheme::Bdf2 : Scheme::BackwardEuler);
    const bool has_event =
        solved
        && (colliders_.has_changed_touch(potential_.positions())
            || surfaces_.has_changed_touch(potential_.positions()) || !grid_hold_.empty());
    if (has_event && is_smooth)
        solved = solve_step(state, dt, Scheme::BackwardEuler);
    if (!solved)
        return false;

    Field x_before = state.x, v_before = state.v;
    end_implicit(state, dt);
    if (has_event) {
        for (Field* before : {&x_before, &v_before, &state.grid.x_before, &state.grid.v_before})
            before->clear();
    }
    state.x_before = std::move(x_before);
    state.v_before = std::move(v_before);
    return true;
}

bool Stepper::solve_step(State& state, double dt, Scheme scheme) {
    begin_step(state, dt, scheme);
    begin_contact(state.x);
    guess(state, dt);

    NewtonOptions options;
    options.tolerance = dynamic_tolerance;
    options.before_iteration = watch_;
    if (scene_.solver.steps == Steps::SemiImplicit) {
        options.max_iterations = 1;
        options.line_search = false;
        options.tolerance = semi_implicit_forcing;
    }
    if (!surfaces_.empty()) {
        map_.move(potential_.step().x_n, dt_hat_, q_, x_end_);
        surfaces_.begin_step({state.x, state.v, state.top_speed, state.contacts}, x_end_, dt);
    }
    const auto is_settled = [&](int pass) {
        if (is_contact_settled(state.x, pass))
            return true;
        if (scene_.solver.steps == Steps::SemiImplicit)
            start_from_rest();
        return false;
    };
    if (!minimize_with_contact(options, is_settled))
        return false;
    q_moved_ = q_;
    move_corners();
    balance_momentum();
    return true;
}

bool Stepper::minimize_with_contact(const NewtonOptions& options,
                                    const std::function<bool(int)>& is_settled) {
    for (int pass = 1;; ++pass) {
        summary_ = minimize(potential_, options, q_, scratch_);
        newton_iterations += summary_.iterations;
        cg_iterations += summary_.linear_iterations;
        if (summary_.termination == Termination::NotFinite && summary_.iterations == 0
            && start_from_rest())
            continue;
        if (summary_.termination != Termination::Converged)
            return false;
        if (is_settled(pass))
            return true;
    }
}

bool Stepper::are_surfaces_settled(int pass, int most_passes) {
    // Surfaces are linearised where the step is expected to end: again, where it ends elsewhere.
    return pass >= most_passes || surfaces_.empty()
           || surfaces_.relinearize(potential_.positions()) < depth_tolerance;
}

bool Stepper::is_contact_settled(const Field& x_n, int pass) {
    const int most_passes = scene_.solver.steps == Steps::SemiImplicit ? 1 : contact_passes;
    const bool fit = are_surfaces_settled(pass, most_passes);
    return (grid_contact_->is_empty() || pass >= grid_passes || is_grid_settled(x_n)) && fit;
}

bool Stepper::is_grid_settled(const Field& x_n) {
    q_moved_ = q_;
    moved_.resize(x_n.size());
    map_.apply(q_moved_, moved_);
    restrain_on_grid(x_n, dt_hat_);
    std::vector<GridHold::Contact> met;
    for (const GridContact::Meeting& meeting : grid_contact_->meetings()) {
        const GridHold::Place place{meeting.pair, meeting.node};
        if (grid_hold_.has(place))
            continue;
        const Impulses::Settled impulse = (*impulses_)[meeting.impulse];
        met.push_back({place,
                       meeting.touch.normal,
                       meeting.touch.edge,
                       meeting.touch.friction,
                       grid_contact_->shares_of(meeting),
                       impulses_->mass(meeting.impulse),
                       impulse.push / dt_hat_,
                       impulse.hold / dt_hat_});
    }
    return grid_hold_.update(potential_.positions(), std::move(met));
}

bool Stepper::start_from_rest() {
    // A guess may turn a domain inside out that the step itself does not: where corners are now is the safer start.
    const auto& step = potential_.step();
    double change = 0;
    for (int i = 0; i < map_.n_dofs(); ++i) {
        const Vec3p guessed = q_[i] * step.is_free[i];
        change += dot(guessed, guessed);
        q_[i] -= guessed;
    }
    return change > 0;
}

void Stepper::end_implicit(State& state, double dt) {
    set_reactions();
    state.contacts = surfaces_.held(potential_.positions());
    // What inner forces gave, before what is left of contact on the grid changes what moves the corners.
    const auto& step = potential_.step();
    set_node_reactions([&](int, int i) {
        return (step.mass[i] * (q_[i] - step.q_tilde[i]) + potential_.inner_part()[i])
               / dt_hat_;
    });
    keep_inner_force(state);
    if (restrain_on_grid(state.x, dt_hat_))
        move_corners();
    drift(potential_.step().x_n, dt_hat_);
    end_on_targets();
    commit(state, dt);
    commit_affine(state, q_moved_);
    for (std::size_t b = 0; b < points_.size(); ++b)
        if (points_[b]) {
            points_[b]->advance(q_moved_, dt_hat_);
            points_[b]->accept(state.points[b]);
        }
}

void Stepper::keep_inner_force(State& state) {
    // What free corners gained tells their forces. Of slaved corners stress tells more, but the solve leaves over a part of
    // it, dynamic_tolerance, and the next guess would move them by (w dt)² as much: only where steps are short.
    std::swap(state.inner_force, state.inner_force_before);
    const auto& step = potential_.step();
    Field& change = q_;
    for (int i = 0; i < map_.n_dofs(); ++i)
        change[i] = (q_[i] - step.q_tilde[i]) * step.is_free[i];
    const double damped = 1 + scene_.solver.damping * dt_hat_;
    const auto force = [&](int c, const Vec3p& gained) {
        return damped / dt_hat_ * assembly_.mass[c] * gained;
    };
    for (int k = 0; k < map_.n_free(); ++k) {
        const int c = map_.free_corner()[k];
        state.inner_force[c] = force(c, change[k]);
    }
    const std::vector<AssembledBody>& bodies = assembly_.bodies;
    const auto is_short = [&](const AssembledBody& body) {
        return !body.points && dt_hat_ * body.highest_frequency < short_step;
    };
    if (!std::all_of(bodies.begin(), bodies.end(), is_short))
        map_.apply_to_slaves(change, corner_);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const CornerMap::Slaves slaves = map_.slaves_of(static_cast<int>(b));
        for (int s = slaves.begin; s < slaves.end; ++s) {
            const int c = map_.slave_corner()[s];
            state.inner_force[c] =
                is_short(bodies[b]) ? -potential_.corner_gradient()[c] : force(c, corner_[c]);
        }
    }
    if (state.last_dt == 0)
        state.inner_force_before = state.inner_force;
}

void Stepper::guess(const State& state, double dt) {
    // Inner forces change smoothly: they go on as from the step before to the last. They are kept on corners, where they
    // do not depend on how the map of this step differs from the last one's. The paper's single solve is linearised at
    // x_n, hence starts from rest.
    if (scene_.solver.steps == Steps::SemiImplicit || state.last_dt == 0)
        return;
    const auto& step = potential_.step();
    const double ahead = std::min(1.0, dt / state.last_dt);
    for (std::size_t c = 0; c < state.x.size(); ++c)
        corner_[c] = step.dt
                     * (state.inner_force[c]
                        + ahead * (state.inner_force[c] - state.inner_force_before[c]));
    const Field& impulse = map_.applied_transposed(corner_, scratch_.trial);
    const double damped = 1 + scene_.solver.damping * dt_hat_;
    for (int i = 0; i < map_.n_dofs(); ++i)
        q_[i] += step.is_free[i] * (step.q_tilde[i] + inverse_mass_[i] / damped * impulse[i]);
}

void Stepper::move_corners() {
    moved_.resize(v_hat_.size());
    map_.apply(q_moved_, moved_);
    for (std::size_t b = 0; b < ranges_.size(); ++b)
        for (int c = ranges_[b].begin; c < ranges_[b].end; ++c)
            moved_[c] += shift_[b];
}

void Stepper::balance_momentum() {
    // The solve is inexact. The momentum of a body that nothing holds is known without it: elastic forces sum to zero,
    // and what colliders give is in the gradient.
    const double damped = 1 + scene_.solver.damping * dt_hat_;
    for (std::size_t b = 0; b < assembly_.bodies.size(); ++b) {
        const AssembledBody& body = assembly_.bodies[b];
        if (is_held(static_cast<int>(b)))
            continue;
        Vec3p missing{};
        double mass = 0;
        for (int c = body.begin; c < body.end; ++c) {
            const Vec3p force = assembly_.force[c] - potential_.corner_gradient()[c];
            missing += (assembly_.mass[c] * v_hat_[c] + dt_hat_ * force) / damped
                       - assembly_.mass[c] * moved_[c];
            mass += assembly_.mass[c][0];
        }
        shift_[b] = missing / mass;
        for (int c = body.begin; c < body.end; ++c)
            moved_[c] += shift_[b];
    }
}

void Stepper::set_reactions() {
    // Force of the pin on a corner: m dv/dt - f + ∂Φ/∂x at the end of the step.
    reaction_.assign(moved_.size(), Vec3p{});
    const double damped = 1 + scene_.solver.damping * dt_hat_;
    for (const int c : prescribed_.corners) {
        const Vec3p v_new = q_[map_.dof_of_corner()[c]];
        const Vec3p inertia = assembly_.mass[c] * (damped * v_new - v_hat_[c]) / dt_hat_;
        reaction_[c] = (inertia - assembly_.force[c] + potential_.corner_gradient()[c])
                       * (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]);
    }
}

}  // namespace sim
