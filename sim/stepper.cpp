#include "sim/stepper.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr double forgetting = 1;  // rate at which a body's top speed fades [1/s]

double energy_scale(const Lattice& lattice) {
    double sum = 0;
    for (int p = 0; p < lattice.n_domains(); ++p)
        sum += lattice.domain_volume(p) * (lattice.lambda[p] + 2 * lattice.mu[p]);
    return sum;
}

std::vector<IncrementalPotential::ElasticBody> elastic_bodies(Assembly& assembly) {
    std::vector<IncrementalPotential::ElasticBody> result;
    for (AssembledBody& body : assembly.bodies)
        if (body.points)
            result.push_back({nullptr, body.begin, body.end, 0});
        else
            result.push_back(
                {body.elasticity.get(), body.begin, body.end, energy_scale(body.lattice)});
    return result;
}

std::vector<ContactSurface> contact_surfaces(const Scene& scene, const Assembly& assembly) {
    std::vector<ContactSurface> result;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        const AssembledBody& body = assembly.bodies[b];
        if (!body.points)
            result.emplace_back(scene.bodies[b], body.lattice, body.begin, static_cast<int>(b));
    }
    return result;
}

double contact_hardness(const Scene& scene) {
    // One solve meets surfaces where they were expected, not where they are: half as deep, it is still no deeper than 2%.
    return scene.solver.steps == Steps::SemiImplicit ? 2 : 1;
}

}  // namespace

Stepper::Stepper(const Scene& scene, Assembly& assembly)
    : scene_(scene),
      assembly_(assembly),
      colliders_(scene.colliders, assembly.contact_corners()),
      friction_(scene),
      surfaces_(scene.contact.mode == Contact::Mode::Surface ? contact_surfaces(scene, assembly)
                                                             : std::vector<ContactSurface>{},
                friction_,
                contact_hardness(scene)),
      potential_(map_,
                 elastic_bodies(assembly),
                 {&colliders_, &surfaces_, &grid_hold_},
                 make_points()) {
    if (scene.contact.mode == Contact::Mode::Grid)
        measured_.emplace(
            contact_surfaces(scene, assembly), friction_, contact_hardness(scene));
    // What meets on the grid, also parts of one body, must have its nodes in common; what APIC and points remember belongs
    // to places in it; and where corners turn free and slaved all the time, FLIP lets them keep what no map in between sees.
    moves_grid_ = scene.contact.mode == Contact::Mode::Surface
                  && scene.solver.transfer == Transfer::Flip && !scene.solver.enrich.strain
                  && scene.solver.steps != Steps::Static && !has_points_;
    for (const AssembledBody& body : assembly.bodies)
        highest_frequency_.push_back(body.highest_frequency);
    for (std::size_t b = 0; b < points_.size(); ++b)
        if (!points_[b])
            bodies_of_domains_.push_back(static_cast<int>(b));
    for (const AssembledBody& body : assembly.bodies)
        ranges_.push_back({body.begin,
                           body.end,
                           body.cell_size,
                           body.kernel,
                           moves_grid_ ? &body.lattice.corners : nullptr});
}

void Stepper::begin_step(State& state, double dt, Scheme scheme) {
    prescribe(scene_, assembly_, state.time, state.time + dt, prescribed_);
    start_scheme(state, dt, scheme);
    make_map(state, potential_.step().x_n);
    transfer_to_nodes(state, potential_.step().x_n, v_hat_, nullptr);
    expect_free_motion();
    prescribe_dofs(state, potential_.step().x_n, dt_hat_, dt);
    q_.assign(map_.n_dofs(), Vec3p{});
    for (const PrescribedDof& held : held_)
        q_[held.dof] = held.velocity;
    begin_forces(state);
    colliders_.begin_step(state.x, state.top_speed, state.time, dt);
    grid_hold_.begin_step(potential_.step().x_n, dt_hat_);
}

void Stepper::begin_forces(const State& state) {
    for (std::size_t b = 0; b < points_.size(); ++b)
        if (points_[b])
            points_[b]->begin_step(state.points[b]);
}

void Stepper::make_map(State& state, const Field& x) {
    if (moves_grid_)
        return keep_map(state, x);
    free_.resize(x.size());
    for (std::size_t b = 0; b < ranges_.size(); ++b)
        choose_free_corners(static_cast<int>(b), state.x);
    map_.rebuild(x, free_, ranges_);
}

void Stepper::choose_free_corners(int b, const Field& x) {
    AssembledBody& body = assembly_.bodies[b];
    const bool all = body.method == Method::Fem || scene_.solver.steps == Steps::Static;
    std::fill(free_.begin() + body.begin, free_.begin() + body.end, all);
    if (!all && body.enrichment)
        body.enrichment->update(body.lattice, &x[body.begin], &free_[body.begin]);
    for (const int c : prescribed_.corners)
        if (c >= body.begin && c < body.end)
            free_[c] = 1;
}

void Stepper::start_scheme(const State& state, double dt, Scheme scheme) {
    auto& step = potential_.step();
    step.x_n = state.x;
    v_hat_ = state.v;
    dt_hat_ = dt;
    history_ = 0;
    if (scheme == Scheme::Bdf2) {
        // With w the ratio to the step before: x_{n+1} = x_n + w²/(1+2w) (x_n - x_{n-1}) + (1+w)/(1+2w) dt v_{n+1}.
        const bool is_first = state.x_before.empty();
        const double ratio = is_first ? 1 : dt / state.last_dt;
        history_ = ratio * ratio / (1 + 2 * ratio);
        for (std::size_t c = 0; c < state.x.size(); ++c) {
            const auto [dx, dv] = is_first ? motion_before(state, dt, static_cast<int>(c))
                                           : Motion{state.x[c] - state.x_before[c],
                                                    state.v[c] - state.v_before[c]};
            step.x_n[c] += history_ * dx;
            v_hat_[c] += history_ * dv;
        }
        dt_hat_ = dt * (1 + ratio) / (1 + 2 * ratio);
    }
    step.dt = dt_hat_;
}

Stepper::Motion Stepper::motion_before(const State& state, double dt, int c) const {
    // Bodies start without stress: what they did just before the start is known to second order from v and f alone.
    const Vec3p is_free = prescribed_.is_free[c];
    const Vec3p dv = (dt / assembly_.mass[c][0]) * assembly_.force[c];
    const Vec3p prescribed_dx =
        (prescribed_.target[c] - state.x[c]) * (Vec3p{1, 1, 1, 0} - is_free);
    return {is_free * (dt * state.v[c] - dt / 2 * dv) + prescribed_dx, is_free * dv};
}

void Stepper::expect_free_motion() {
    // q~ = (q_n + dt^ M⁻¹ f) / (1 + damping dt^); damping acts at the end of the step, inside M.
    const int n = map_.n_dofs();
    const double damped = 1 + scene_.solver.damping * dt_hat_;
    auto& step = potential_.step();
    step.q_tilde.resize(n);
    step.mass.resize(n);
    for (int k = 0; k < map_.n_free(); ++k) {
        const int c = map_.free_corner()[k];
        q_n_[k] = v_hat_[c];
        node_force_[k] = assembly_.force[c];
    }
    for (int i = 0; i < n; ++i) {
        const double mass = damped * dof_mass_[i];
        step.q_tilde[i] = (q_n_[i] + dt_hat_ * inverse_mass_[i] * node_force_[i]) / damped;
        step.mass[i] = mass;
    }
    step.static_force.clear();
}

void Stepper::prescribe_dofs(const State& state, const Field& x_n, double drift, double dt) {
    // Prescribed components move exactly to their targets, from x_n at one velocity for the time of the drift.
    auto& step = potential_.step();
    step.is_free.assign(map_.n_dofs(), Vec3p{1, 1, 1, 0});
    held_.clear();
    for (const int c : prescribed_.corners) {
        const Vec3p is_held = Vec3p{1, 1, 1, 0} - prescribed_.is_free[c];
        const Vec3p velocity =
            drift > 0 ? (prescribed_.target[c] - x_n[c]) / drift : state.v[c];
        held_.push_back({map_.dof_of_corner()[c], velocity * is_held});
        step.is_free[held_.back().dof] = prescribed_.is_free[c];
    }
    pinned_nodes_ = pinned_nodes(scene_, assembly_, map_, dof_mass_, state.time, dt);
    for (const PinnedNode& node : pinned_nodes_) {
        held_.push_back({node.dof, node.velocity});
        step.is_free[node.dof] = node.is_free;
    }
}

bool Stepper::is_held(int body) const {
    const CornerMap::BodyRange& range = ranges_[body];
    return std::any_of(prescribed_.corners.begin(),
                       prescribed_.corners.end(),
                       [&](int c) { return c >= range.begin && c < range.end; })
           || std::any_of(
               pinned_nodes_.begin(), pinned_nodes_.end(), [&](const PinnedNode& node) {
                   return map_.dof_body()[node.dof] == body;
               });
}

void Stepper::end_on_targets() {
    for (const int c : prescribed_.corners)  // no drift by rounding
        for (int axis = 0; axis < 3; ++axis)
            if (prescribed_.is_free[c][axis] == 0)
                x_end_[c][axis] = prescribed_.target[c][axis];
}

void Stepper::commit(State& state, double dt) {
    // Corner velocities: the new ones of the degrees of freedom, and for slaved corners what a grid at rest could not see
    // of the old ones (FLIP).
    way_.resize(map_.n_dofs());
    for (int i = map_.n_free(); i < map_.n_dofs(); ++i)
        way_[i] = dt_hat_ * q_moved_[i];
    state.v = moved_;
    if (!moves_grid_) {
        const double damped = 1 + scene_.solver.damping * dt_hat_;
        const Memory memory{1, 1 / damped, share_kept(dt)};  // forces act at the end
        Field& seen = corner_;
        map_.apply_to_slaves(q_n_, seen);
        for (const int c : map_.slave_corner())
            state.v[c] -= memory.unseen * seen[c];
        return_to_slaves(
            potential_.step().x_n, v_hat_, memory, gained_by_nodes(memory), state.v);
    }
    std::swap(state.x, x_end_);
    end_step(state, dt);
}

void Stepper::end_step(State& state, double dt) {
    if (moves_grid_)
        end_grid(state);
    measure_speed(state);
    for (std::size_t b = 0; b < speed_.size(); ++b)
        state.top_speed[b] =
            std::max(speed_[b], std::exp(-forgetting * dt) * state.top_speed[b]);
    state.last_dt = dt;
    state.time += dt;
}

void Stepper::measure_speed(const State& state) {
    speed_.clear();
    for (const CornerMap::BodyRange& range : ranges_) {
        double squared = 0;
        for (int c = range.begin; c < range.end; ++c)
            squared = std::max(squared, dot(state.v[c], state.v[c]));
        speed_.push_back(std::sqrt(squared));
    }
}

void Stepper::refresh(State& state) {
    begin_step(state, 0, Scheme::BackwardEuler);
    q_moved_ = q_ = q_n_;
    const bool is_explicit = scene_.solver.steps == Steps::Explicit;
    Field on_dofs;
    if (is_explicit)  // contact is no energy there
        potential_.elastic_gradient(state.x, gradient_);
    else
        potential_.value_and_gradient(q_, on_dofs);
    const Field& gradient = is_explicit ? gradient_ : potential_.corner_gradient();
    Field inner(map_.n_dofs()), force(map_.n_dofs());
    add_start_gradient(inner);
    map_.apply_transposed(assembly_.force, force);
    set_node_reactions([&](int, int i) { return inner[i] - force[i]; });
    reaction_.assign(state.x.size(), Vec3p{});
    for (const int c : prescribed_.corners)
        reaction_[c] =
            (gradient[c] - assembly_.force[c]) * (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]);
}

double Stepper::mass_on_dofs() const {
    double sum = 0;
    for (const double mass : dof_mass_)
        sum += mass;
    return sum;
}

}  // namespace sim
