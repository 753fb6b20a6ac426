#include "sim/stepper.h"

#include "sim/base/parallel.h"
#include "sim/diagnosis.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int chunk = 8192;

// The share of PIC is a rate: exp(-pic_rate dt) of the difference between a corner's velocity and the grid's is kept
// per step, so that halving dt does not drain more (the paper keeps 0.95 per step).
constexpr double pic_rate = 5;  // [1/s]

constexpr double dynamic_tolerance = 1e-3;  // of the inner forces of the step
constexpr double static_tolerance = 1e-8;
constexpr double semi_implicit_forcing = 1e-6;
constexpr int most_halvings = 8;  // of the way to an equilibrium

std::vector<IncrementalPotential::ElasticBody> elastic_bodies(Assembly& assembly) {
    std::vector<IncrementalPotential::ElasticBody> result;
    for (AssembledBody& body : assembly.bodies)
        result.push_back({&body.elasticity, body.begin, body.end});
    return result;
}

}  // namespace

Stepper::Stepper(const Scene& scene, Assembly& assembly)
    : scene_(scene),
      assembly_(assembly),
      colliders_(scene.colliders, assembly.contact_corners()),
      potential_(map_, elastic_bodies(assembly), colliders_) {
    for (const AssembledBody& body : assembly.bodies)
        ranges_.push_back({body.begin, body.end, body.cell_size});
}

void Stepper::choose_free_corners(const Field& x) {
    const Method method =
        scene_.solver.steps == Steps::Static ? Method::Fem : scene_.solver.method;
    free_.assign(x.size(), method == Method::Fem);
    if (method == Method::Enriched)
        for (AssembledBody& body : assembly_.bodies)
            body.enrichment.update(body.lattice, &x[body.begin], &free_[body.begin]);
    for (const int c : prescribed_.corners)
        free_[c] = 1;
    map_.rebuild(x, free_, ranges_);
}

void Stepper::transfer(const State& state, double dt) {
    // Mass and momentum to the degrees of freedom: M = Tᵀ m, M q_n = Tᵀ (m v). Lumped means over the corners around a
    // node see a rotation too slow where corners lie on one side of it, so the body's rigid motion goes over by its
    // value at the node and only the rest by means: rigid motion is exact, and so is momentum, as Σ_i w_ic x_i = x_c.
    const std::vector<RigidMotion> rigid = rigid_motions(state);
    const int n = map_.n_dofs();
    auto& step = potential_.step();
    dof_mass_.resize(n);
    q_n_.resize(n);
    step.q_tilde.resize(n);
    step.mass.resize(n);
    corner_.resize(state.x.size());
    map_.apply_transposed(assembly_.mass, dof_mass_);
    for (std::size_t b = 0; b < rigid.size(); ++b)
        for (int c = ranges_[b].begin; c < ranges_[b].end; ++c)
            corner_[c] = assembly_.mass[c] * (state.v[c] - rigid[b].at(state.x[c]));
    map_.apply_transposed(corner_, q_n_);
    map_.apply_transposed(assembly_.force, step.q_tilde);

    // q~ = (q_n + dt M⁻¹ f) / (1 + damping dt); damping acts at the end of the step, inside M.
    // A node that corners only touch with weight zero has no mass: it is held, and nothing depends on it.
    const double damped = 1 + scene_.solver.damping * dt;
    step.is_free.assign(n, Vec3p{1, 1, 1, 0});
    inverse_mass_.resize(n);
    for (int i = 0; i < n; ++i) {
        const double mass = dof_mass_[i][0];
        const double inverse_mass = mass > 0 ? 1 / mass : 0;
        inverse_mass_[i] = inverse_mass;
        if (!(mass > 0))
            step.is_free[i] = Vec3p{};
        q_n_[i] = rigid[map_.dof_body()[i]].at(map_.dof_position()[i]) + inverse_mass * q_n_[i];
        step.q_tilde[i] = (q_n_[i] + dt * inverse_mass * step.q_tilde[i]) / damped;
        step.mass[i] = damped * dof_mass_[i];
    }

    // Prescribed components move exactly to their targets.
    step.dt = dt;
    step.x_n = state.x;
    step.static_force.clear();
    for (const int c : prescribed_.corners)
        step.is_free[map_.dof_of_corner()[c]] = prescribed_.is_free[c];
}

std::vector<RigidMotion> Stepper::rigid_motions(const State& state) const {
    std::vector<RigidMotion> result(ranges_.size());
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        const auto& [begin, end, cell_size] = ranges_[b];
        RigidMotion& rigid = result[b];
        double mass = 0;
        for (int c = begin; c < end; ++c) {
            mass += assembly_.mass[c][0];
            rigid.centre += assembly_.mass[c] * state.x[c];
            rigid.velocity += assembly_.mass[c] * state.v[c];
        }
        rigid.centre /= mass;
        rigid.velocity /= mass;
        // Inertia I = Σ m (r² 1 - r rᵀ) and angular momentum L about the centre; I spin = L.
        Mat3 second_moment = Mat3::Zero();
        Vec3 L = Vec3::Zero();
        for (int c = begin; c < end; ++c) {
            const Vec3 r = unpadded(state.x[c] - rigid.centre),
                       v = unpadded(state.v[c] - rigid.velocity);
            second_moment += assembly_.mass[c][0] * r * r.transpose();
            L += assembly_.mass[c][0] * r.cross(v);
        }
        const Mat3 inertia = second_moment.trace() * Mat3::Identity() - second_moment;
        rigid.spin = padded(inertia.ldlt().solve(L));
    }
    return result;
}

void Stepper::guess(const State& state, double dt) {
    // Inner forces change little from one step to the next: start from their last impulse.
    const int n = map_.n_dofs();
    const auto& step = potential_.step();
    q_.resize(n);
    const double ratio = state.last_dt > 0 ? dt / state.last_dt : 0;
    for (std::size_t c = 0; c < state.x.size(); ++c)
        corner_[c] = ratio * assembly_.mass[c] * state.inner_impulse[c];
    map_.apply_transposed(corner_, q_);
    const bool from_rest = scene_.solver.steps == Steps::SemiImplicit;  // linearised at x_n
    for (int i = 0; i < n; ++i)
        q_[i] = from_rest ? Vec3p{} : step.q_tilde[i] + inverse_mass_[i] * q_[i];
    for (int i = 0; i < n; ++i)
        q_[i][3] = 0;
    for (const int c : prescribed_.corners) {
        const int i = map_.dof_of_corner()[c];
        const Vec3p velocity = (prescribed_.target[c] - state.x[c]) / dt;
        q_[i] = prescribed_.is_free[c] * q_[i]
                + (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]) * velocity;
    }
}

void Stepper::step(State& state, double dt) {
    prescribed_ = prescribe(scene_, assembly_, state.time, state.time + dt);
    choose_free_corners(state.x);
    transfer(state, dt);
    colliders_.begin_step(state.x, dt);
    guess(state, dt);

    NewtonOptions options;
    options.tolerance = dynamic_tolerance;
    if (scene_.solver.steps == Steps::SemiImplicit) {
        options.max_iterations = 1;
        options.line_search = false;
        options.tolerance = semi_implicit_forcing;
    }
    const NewtonSummary summary = minimize(potential_, options, q_, scratch_);
    newton_iterations += summary.iterations;
    cg_iterations += summary.linear_iterations;
    if (summary.termination != Termination::Converged)
        fail(state, dt, summary);
    move(state, dt);
    ++steps;
}

void Stepper::move(State& state, double dt) {
    // Corner velocities: the new ones of the degrees of freedom, and for slaved corners what the grid could not see
    // of the old ones (FLIP), fading at the rate of PIC.
    const int n_corners = static_cast<int>(state.x.size());
    Field& u = corner_;
    map_.apply(q_, u);
    balance_momentum(state, dt, u);
    Field contact_velocity;
    if (assembly_.bodies.size() > 1) {
        contact_velocity = u;
        std::vector<ContactBody> bodies;
        double cell_size = 0;
        for (const AssembledBody& body : assembly_.bodies) {
            bodies.push_back({body.begin, body.end});
            cell_size = std::max(cell_size, body.lattice.edge);
        }
        exchange_on_grid(bodies,
                         {state.x, assembly_.mass, assembly_.outside, prescribed_.is_free},
                         cell_size,
                         dt,
                         scene_.contact,
                         contact_velocity);
        see_on_grid(u, contact_velocity);
    }
    set_reactions(state, dt);

    Field u_n(n_corners), inner(n_corners), inner_dofs(map_.n_dofs());
    const auto& step = potential_.step();
    for (int i = 0; i < map_.n_dofs(); ++i)
        inner_dofs[i] = (q_[i] - step.q_tilde[i]) * step.is_free[i];
    map_.apply(q_n_, u_n);
    map_.apply(inner_dofs, inner);
    const double keep = std::exp(-pic_rate * dt);
    for (int c = 0; c < n_corners; ++c) {
        const Vec3p unseen = free_[c] ? Vec3p{} : keep * (state.v[c] - u_n[c]);
        const Vec3p moved = contact_velocity.empty() ? u[c] : contact_velocity[c];
        state.x[c] += dt * moved;
        state.v[c] = moved + unseen;
        state.inner_impulse[c] = inner[c];
    }
    for (const int c : prescribed_.corners)  // no drift by rounding
        for (int axis = 0; axis < 3; ++axis)
            if (prescribed_.is_free[c][axis] == 0)
                state.x[c][axis] = prescribed_.target[c][axis];
    state.last_dt = dt;
    state.time += dt;
}

void Stepper::balance_momentum(const State& state, double dt, Field& u) const {
    // The solve is inexact. The momentum of a body that nothing holds is known without it: elastic forces sum to zero,
    // and what colliders give is in the gradient.
    const double damped = 1 + scene_.solver.damping * dt;
    for (const AssembledBody& body : assembly_.bodies) {
        const bool held = std::any_of(prescribed_.corners.begin(),
                                      prescribed_.corners.end(),
                                      [&](int c) { return c >= body.begin && c < body.end; });
        if (held)
            continue;
        Vec3p missing{};
        double mass = 0;
        for (int c = body.begin; c < body.end; ++c) {
            const Vec3p force = assembly_.force[c] - potential_.corner_gradient()[c];
            missing += (assembly_.mass[c] * state.v[c] + dt * force) / damped
                       - assembly_.mass[c] * u[c];
            mass += assembly_.mass[c][0];
        }
        for (int c = body.begin; c < body.end; ++c)
            u[c] += missing / mass;
    }
}

void Stepper::see_on_grid(const Field& u, Field& contact_velocity) const {
    // A slaved corner can only move as its grid does. Were it given more, the next step would not know of it, ask for
    // the same again, and pile up speed: so contact's change goes through the map, T M⁻¹ Tᵀ m, free corners as it is.
    Field change(u.size()), dofs(map_.n_dofs());
    for (std::size_t c = 0; c < u.size(); ++c)
        change[c] = assembly_.mass[c] * (contact_velocity[c] - u[c]);
    map_.apply_transposed(change, dofs);
    for (int i = 0; i < map_.n_dofs(); ++i)
        dofs[i] *= inverse_mass_[i];
    map_.apply(dofs, change);
    for (std::size_t c = 0; c < u.size(); ++c)
        contact_velocity[c] = u[c] + change[c];
}

void Stepper::set_reactions(const State& state, double dt) {
    // Force of the pin on a corner: m dv/dt - f + ∂Φ/∂x at the end of the step.
    reaction_.assign(state.x.size(), Vec3p{});
    const double damped = 1 + scene_.solver.damping * dt;
    for (const int c : prescribed_.corners) {
        const Vec3p v_new = q_[map_.dof_of_corner()[c]];
        const Vec3p inertia = assembly_.mass[c] * (damped * v_new - state.v[c]) / dt;
        reaction_[c] = (inertia - assembly_.force[c] + potential_.corner_gradient()[c])
                       * (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]);
    }
}

void Stepper::equilibrium(State& state, double time) {
    // The whole way in one solve, else in halves.
    double begin = state.time, length = time - state.time;
    int halvings = 0;
    for (;;) {
        NewtonSummary summary;
        const double end = halvings == 0 ? time : std::min(time, begin + length);
        if (try_equilibrium(state, begin, end, summary)) {
            if (end >= time)
                break;
            begin = end;
            continue;
        }
        if (++halvings > most_halvings || length == 0)
            fail(state, 0, summary);
        length /= 2;
    }
    state.time = time;
}

bool Stepper::try_equilibrium(State& state,
                              double time_begin,
                              double time_end,
                              NewtonSummary& summary) {
    prescribed_ = prescribe(scene_, assembly_, time_begin, time_end);
    choose_free_corners(state.x);
    const int n = map_.n_dofs();
    auto& step = potential_.step();
    step.dt = 1;  // degrees of freedom are displacements
    step.x_n = state.x;
    step.mass.assign(n, Vec3p{});
    step.q_tilde.assign(n, Vec3p{});
    step.static_force = assembly_.force;
    step.is_free.assign(n, Vec3p{1, 1, 1, 0});
    map_.apply_transposed(assembly_.mass, dof_mass_ = Field(n));
    q_.assign(n, Vec3p{});
    for (const int c : prescribed_.corners) {
        const int i = map_.dof_of_corner()[c];
        step.is_free[i] = prescribed_.is_free[c];
        q_[i] =
            (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]) * (prescribed_.target[c] - state.x[c]);
    }
    colliders_.begin_step(state.x, 0);

    NewtonOptions options;
    options.tolerance = static_tolerance;
    options.first_forcing = 0.1;
    options.max_iterations = 200;
    summary = minimize(potential_, options, q_, scratch_);
    newton_iterations += summary.iterations;
    cg_iterations += summary.linear_iterations;
    if (summary.termination != Termination::Converged)
        return false;

    state.x = potential_.positions();
    state.v.assign(state.x.size(), Vec3p{});
    state.inner_impulse.assign(state.x.size(), Vec3p{});
    state.time = time_end;
    reaction_.assign(state.x.size(), Vec3p{});
    for (const int c :
         prescribed_.corners)  // the potential's gradient holds the external force already
        reaction_[c] =
            potential_.corner_gradient()[c] * (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]);
    ++steps;
    return true;
}

void Stepper::refresh(const State& state) {
    prescribed_ = prescribe(scene_, assembly_, state.time, state.time);
    choose_free_corners(state.x);
    transfer(state, 0);
    colliders_.begin_step(state.x, 0);
    q_ = q_n_;
    Field gradient;
    potential_.value_and_gradient(q_, gradient);
    reaction_.assign(state.x.size(), Vec3p{});
    for (const int c : prescribed_.corners)
        reaction_[c] = (potential_.corner_gradient()[c] - assembly_.force[c])
                       * (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]);
}

double Stepper::mass_on_dofs() const {
    double sum = 0;
    for (const Vec3p& mass : dof_mass_)
        sum += mass[0];
    return sum;
}

void Stepper::fail(const State& state, double dt, const NewtonSummary& summary) {
    throw diagnose(scene_, assembly_, state, potential_.positions(), dt, summary);
}

}  // namespace sim
