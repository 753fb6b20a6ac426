// Explicit steps: kick, drift, kick (velocity Verlet).
#include "sim/base/parallel.h"
#include "sim/stepper.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int chunk = 8192;
constexpr double safety = 0.8;  // of the stable step of the bodies at rest: stretching stiffens
constexpr double most_excited =
    1.9;                            // w dt of the motion seen; beyond 2 it grows without bound
constexpr double most_cells = 0.3;  // that a corner may pass in a step
constexpr int contact_passes = 6;
constexpr double depth_tolerance = 1e-3;  // of a linearised depth, in domain edges
constexpr double noise =
    1e-8;  // of the kinetic energy: strain energy too small to tell a frequency

}  // namespace

double Stepper::explicit_limit(const State& state) const {
    double limit = std::numeric_limits<double>::infinity();
    for (const AssembledBody& body : assembly_.bodies) {
        double speed_squared = 0;
        for (int c = body.begin; c < body.end; ++c)
            speed_squared = std::max(speed_squared, dot(state.v[c], state.v[c]));
        const PointEnergy* points = points_[&body - assembly_.bodies.data()].get();
        const double highest =
            points ? points->highest_frequency(body.kernel) : body.highest_frequency;
        limit = std::min({limit,
                          safety * 2 / highest,
                          most_cells * body.cell_size / std::sqrt(speed_squared)});
    }
    return limit;
}

double Stepper::seen_frequency(const State& state) const {
    // w² = |M⁻¹ dg|²_M / dx·dg, with dg the change of the forces over dx: of the modes in dx the fastest weigh most.
    const int n = static_cast<int>(state.x.size());
    const Vec3p sums = sum_chunks(n, chunk, [&](int begin, int end) {
        Vec3p sum{};
        for (int c = begin; c < end; ++c) {
            const Vec3p dx = x_end_[c] - state.x[c];
            const Vec3p dg = (end_gradient_[c] - gradient_[c]) * prescribed_.is_free[c];
            const double m = assembly_.mass[c][0];
            sum += Vec3p{dot(dg, dg) / m, dot(dx, dg), m * dot(dx, dx), 0};
        }
        return sum;
    });
    const double force = sums[0], strain = sums[1], motion = sums[2];
    return strain * dt_hat_ * dt_hat_ > noise * motion ? std::sqrt(force / strain) : 0;
}

bool Stepper::try_explicit(State& state, double dt) {
    begin_step(state, dt, Scheme::Verlet);
    const int n_corners = static_cast<int>(state.x.size()), n_dofs = map_.n_dofs();
    const auto& step = potential_.step();
    const double damped = 1 + scene_.solver.damping * dt_hat_;

    // Kick by half of the forces at the start, and drift.
    Field& buffer = scratch_.trial;
    start_gradient_.assign(n_dofs, Vec3p{});
    add_start_gradient(start_gradient_);
    for (int i = 0; i < n_dofs; ++i)
        q_[i] +=
            step.is_free[i]
            * (step.q_tilde[i] - (dt_hat_ * inverse_mass_[i] / damped) * start_gradient_[i]);
    q_moved_ = q_;
    moved_ = map_.applied(q_, moved_);
    exchange_contact(state, dt);
    summary_ = {};
    if (colliders_.largest_step(state.x, moved_, state.time, dt) < dt) {
        summary_.termination = Termination::Unstable;  // a corner might pass through a collider
        return false;
    }
    restrain_by_contact(state, dt);
    drift(dt);

    // The forces there. The motion must not be faster than the step can follow.
    grid_gradient_.assign(n_dofs, Vec3p{});
    if (!std::isfinite(potential_.elastic_gradient(x_end_, end_gradient_)
                       + add_grid_gradient(q_moved_, dt, grid_gradient_)))
        return false;
    if (std::max(seen_frequency(state), seen_frequency_of_points()) * dt > most_excited) {
        summary_.termination = Termination::Unstable;
        return false;
    }

    // Kick by the other half.
    commit(state, dt);
    Field& kick = corner_;
    for (int c = 0; c < n_corners; ++c)
        kick[c] = dt_hat_ * (assembly_.force[c] - end_gradient_[c]);
    Field& dq = q_;
    const Field& impulse = map_.applied_transposed(kick, buffer);
    for (int i = 0; i < n_dofs; ++i)
        dq[i] = inverse_mass_[i] * (impulse[i] - dt_hat_ * grid_gradient_[i]) * step.is_free[i];
    const Field& dv = map_.applied(dq, corner_);
    set_explicit_reactions(state, dt);
    for (int c = 0; c < n_corners; ++c) {
        const Vec3p is_free = prescribed_.is_free[c];
        state.v[c] += is_free * ((state.v[c] + dv[c]) / damped - state.v[c]);
    }
    for (int i = 0; i < n_dofs; ++i)
        q_moved_[i] += step.is_free[i] * ((q_moved_[i] + dq[i]) / damped - q_moved_[i]);
    commit_affine(state, q_moved_);
    for (std::size_t b = 0; b < points_.size(); ++b)
        if (points_[b])
            points_[b]->accept(state.points[b]);
    std::swap(gradient_, end_gradient_);
    return true;
}

void Stepper::restrain_by_contact(const State& state, double dt) {
    restrain_by_surfaces(state, dt);
    if (colliders_.empty())
        return;
    Field& change = end_gradient_;  // not known yet
    change = moved_;
    if (colliders_.restrain(state.x, dt, change))
        move_through_grid(change);
}

void Stepper::restrain_by_surfaces(const State& state, double dt) {
    if (surfaces_.empty())
        return;
    Field inverse_mass(map_.n_dofs());
    for (int i = 0; i < map_.n_dofs(); ++i)
        inverse_mass[i] = inverse_mass_[i] * potential_.step().is_free[i];
    for (int pass = 0; pass < contact_passes; ++pass) {
        // Found where the corners would end: again, as they end elsewhere once they are restrained.
        for (std::size_t c = 0; c < moved_.size(); ++c)
            corner_[c] = state.x[c] + dt * moved_[c];
        if (pass == 0)
            surfaces_.begin_step(
                {state.x, state.v, state.top_speed, state.contacts}, corner_, dt);
        else if (surfaces_.relinearize(corner_) < depth_tolerance)
            return;
        if (!surfaces_.restrain(state.x, map_, inverse_mass, dt, q_moved_) && pass == 0)
            return;
        moved_ = map_.applied(q_moved_, moved_);
    }
}

void Stepper::set_explicit_reactions(const State& state, double dt) {
    // Force of the pin on a corner: m dv/dt - f + ∂Φ/∂x, by the mean of both ends.
    reaction_.assign(state.x.size(), Vec3p{});
    for (const int c : prescribed_.corners) {
        const Vec3p inertia = assembly_.mass[c] * (state.v[c] - v_hat_[c]) / dt;
        const Vec3p gradient = 0.5 * (gradient_[c] + end_gradient_[c]);
        reaction_[c] = (inertia - assembly_.force[c] + gradient)
                       * (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]);
    }
    const auto& step = potential_.step();
    const double damped = 1 + scene_.solver.damping * dt_hat_;
    set_node_reactions([&](int i) {
        const Vec3p change = damped * damped * q_moved_[i] - q_n_[i];
        const Vec3p half_kick = damped * step.q_tilde[i] - q_n_[i];  // of external forces
        return dof_mass_[i] * (change - 2 * half_kick) / dt
               + 0.5 * (start_gradient_[i] + grid_gradient_[i]);
    });
}

}  // namespace sim
