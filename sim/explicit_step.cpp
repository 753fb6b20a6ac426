// Explicit steps: kick, drift, kick (velocity Verlet), where stability asks for it several times.
#include "sim/base/parallel.h"
#include "sim/stepper.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int chunk = 8192;
constexpr double safety = 0.9;            // of the stable step of bodies as they are
constexpr double safety_of_points = 0.7;  // of that of points at rest: pressing stiffens
constexpr double steady = 0.01;   // change of how stiff bodies are, from measure to measure
constexpr int steady_drifts = 8;  // after which what is steady is measured again
// w dt of the motion seen; beyond 2 it grows without bound.
constexpr double most_excited = 1.9;
constexpr double rounding = 1e-9;  // of a way
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int contact_passes = 6;
constexpr double depth_tolerance = 1e-3;  // of a linearised depth, in domain edges
// Depth that a drift would go into a collider, in domain edges.
constexpr double hard_hit = 5e-3;
// Of the kinetic energy: strain energy too small to tell a frequency.
constexpr double noise = 1e-8;

double sum_of(const Vec3p& v) {
    return v[0] + v[1] + v[2];
}

}  // namespace

double Stepper::stable_limit(std::size_t b) const {
    if (const AssembledBody& body = assembly_.bodies[b]; body.points)
        return safety_of_points * 2 / points_[b]->highest_frequency(body.kernel);
    return safety * 2 / (highest_frequency_[b] * std::sqrt(stiffening_[b]));
}

double Stepper::stable_limit() const {
    double limit = infinity;
    for (std::size_t b = 0; b < assembly_.bodies.size(); ++b)
        limit = std::min(limit, stable_limit(b));
    return limit;
}

void Stepper::measure_stiffening(const Field& x) {
    drifts_since_measure_ = 0;
    measure_after_ = 1;
    stiffening_.assign(assembly_.bodies.size(), 1);
    for (std::size_t b = 0; b < assembly_.bodies.size(); ++b)
        if (const AssembledBody& body = assembly_.bodies[b]; !body.points)
            stiffening_[b] = body.elasticity->stiffening(&x[body.begin]);
}

bool Stepper::has_stiffened(double drift) {
    drifts_since_measure_ += n_drifts_;
    if (drifts_since_measure_ < measure_after_)
        return false;
    const std::vector<double> before = stiffening_;
    measure_stiffening(x_end_);
    bool is_steady = true, is_too_stiff = false;
    for (std::size_t b = 0; b < before.size(); ++b) {
        is_steady = is_steady && std::abs(stiffening_[b] - before[b]) < steady * before[b];
        is_too_stiff = is_too_stiff
                       || (!assembly_.bodies[b].points
                           && drift * safety > stable_limit(b) * most_excited / 2);
    }
    if (is_too_stiff)
        stiffening_ = before;  // the step is taken again from there
    else if (is_steady)
        measure_after_ = steady_drifts;
    return is_too_stiff;
}

double Stepper::limit_of_way(double cells) const {
    double limit = infinity;
    for (std::size_t b = 0; b < ranges_.size(); ++b)
        limit = std::min(limit, cells * ranges_[b].cell_size / speed_[b]);
    return limit;
}

double Stepper::limit_of_slaves(const Field& v, double cells) const {
    double limit = infinity;
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        const CornerMap::Slaves slaves = map_.slaves_of(static_cast<int>(b));
        double squared = 0;
        for (int s = slaves.begin; s < slaves.end; ++s) {
            const Vec3p& speed = v[map_.slave_corner()[s]];
            squared = std::max(squared, dot(speed, speed));
        }
        limit = std::min(limit, cells * ranges_[b].cell_size / std::sqrt(squared));
    }
    return limit;
}

bool Stepper::try_explicit(State& state, double dt) {
    const double length = dt / n_drifts_;
    dt_hat_ = length / 2;  // of a kick
    prescribe(scene_, assembly_, state.time, state.time + dt, prescribed_);
    transfer_to_nodes(state, state.x, state.v, &gradient_);
    prescribe_dofs(state, state.x, dt, dt);
    begin_forces(state);

    summary_ = {};
    quiet_drifts_ = state.quiet_drifts;
    first_kick(state);
    if (!take_drifts(state, length))
        return false;
    end_on_targets();

    // Neither bodies nor the motion may have become faster than the step can follow.
    if (has_stiffened(length)) {
        summary_.termination = Termination::Unstable;
        return false;
    }
    if (!std::isfinite(potential_.elastic_gradient(x_end_, end_gradient_)
                       + end_drift(state.x, length))
        || (n_drifts_ > 1 && !has_kept_way(state.x, true)))
        return false;
    add_at_pinned_nodes(0.5);
    const double frequency = second_kick(n_drifts_ == 1 ? gradient_ : gradient_before_);
    if (std::max(frequency, seen_frequency_of_points()) * 2 * dt_hat_ > most_excited) {
        summary_.termination = Termination::Unstable;
        return false;
    }
    set_explicit_reactions(state, dt);
    kick_nodes(state, dt);
    commit_affine(state, q_moved_);
    for (std::size_t b = 0; b < points_.size(); ++b)
        if (points_[b])
            points_[b]->accept(state.points[b]);
    std::swap(state.x, x_end_);
    std::swap(state.v, v_end_);
    std::swap(gradient_, end_gradient_);
    state.quiet_drifts = quiet_drifts_;
    end_step(state, dt);
    return true;
}

void Stepper::first_kick(const State& state) {
    // q = (q_n + dt^ M⁻¹ (f - ∂Φ/∂x)) / (1 + damping dt^)
    const int n = map_.n_dofs(), n_free = map_.n_free();
    const double damped = 1 / (1 + scene_.solver.damping * dt_hat_);
    q_moved_.resize(n);
    for_chunks(n_free, chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            const int c = map_.free_corner()[k];
            const Vec3p force = assembly_.force[c] - gradient_[c];
            q_moved_[k] = damped * (state.v[c] + (dt_hat_ * inverse_mass_[k]) * force);
        }
    });
    way_.assign(n, Vec3p{});
    grid_gradient_.assign(has_points_ ? n : 0, Vec3p{});
    add_start_gradient(grid_gradient_);
    inner_at_nodes_.assign(pinned_nodes_.size(), Vec3p{});
    add_at_pinned_nodes(0.5);
    for (int i = n_free; i < n; ++i) {
        const Vec3p inner = has_points_ ? grid_gradient_[i] : Vec3p{};
        q_moved_[i] =
            damped * (q_n_[i] + (dt_hat_ * inverse_mass_[i]) * (node_force_[i] - inner));
    }
    hold_prescribed();
}

void Stepper::hold_prescribed() {
    for (const PrescribedDof& held : held_)
        q_moved_[held.dof] =
            q_moved_[held.dof] * potential_.step().is_free[held.dof] + held.velocity;
}

bool Stepper::take_drifts(const State& state, double length) {
    begin_contact(state.x);
    colliders_.begin_drift(state.x, infinity, state.time, length);
    if (!take_drift(state, 0, length))
        return false;
    inner_gradient_.assign(prescribed_.corners.size(), Vec3p{});
    for (int k = 1; k < n_drifts_; ++k) {
        if (!std::isfinite(potential_.elastic_gradient(x_end_, gradient_before_)
                           + end_drift(state.x, length)))
            return false;
        add_at_pinned_nodes(1);
        const double gone = longest_way(length);
        kick_between_drifts();
        colliders_.begin_drift(x_end_, gone, state.time + k * length, length);
        if (!take_drift(state, k, length))
            return false;
    }
    return n_drifts_ == 1
           || (has_kept_way(state.x, false) && is_clear_of_surfaces(state, n_drifts_ * length));
}

bool Stepper::take_drift(const State& state, int number, double length) {
    // Velocities of corners are of use where something may be met, and to the kick that ends the step.
    const bool is_first = number == 0, is_last = number + 1 == n_drifts_;
    if (!is_last && colliders_.empty() && grid_contact_->is_empty()) {
        map_.move_bodies(
            bodies_of_domains_, is_first ? state.x : x_end_, length, q_moved_, x_end_);
        ++quiet_drifts_;
        return true;
    }
    if (!is_first)
        std::swap(x_drift_, x_end_);
    const Field& x = is_first ? state.x : x_drift_;
    return drift_with_contact(state, x, number, length);
}

double Stepper::longest_way(double length) const {
    // T takes means.
    if (colliders_.empty())
        return 0;
    Vec3p squared{};
    for (int i = 0; i < map_.n_dofs(); ++i)
        squared = larger(squared, q_moved_[i] * q_moved_[i]);
    return (1 + rounding) * length * std::sqrt(sum_of(squared));
}

bool Stepper::drift_with_contact(const State& state,
                                 const Field& x,
                                 int number,
                                 double length) {
    // Velocities are asked for only where something may be met, unless that is everywhere.
    const bool sees_all = n_drifts_ == 1 && !surfaces_.empty(),
               has_thin = colliders_.has_thin();
    moved_.resize(x.size());
    map_.apply_at(grid_contact_->corners(), q_moved_, moved_);
    restrain_on_grid(x, length);
    if (sees_all || has_thin)
        map_.apply(q_moved_, moved_);
    const double time = state.time + number * length;
    if (has_thin && colliders_.largest_step(x, moved_, time, length) < length) {
        summary_.termination = Termination::Unstable;  // a corner might pass through a collider
        drift(x, length);
        return false;
    }
    const bool presses = sees_all && restrain_by_surfaces(state, length);
    // Many drifts under one map take more from a hit on slaved corners than as many under their own (test_drifts).
    const bool hits = restrain_by_colliders(x, length) > hard_hit && !map_.is_identity();
    quiet_drifts_ = presses || hits ? 0 : quiet_drifts_ + 1;
    const bool is_last = number + 1 == n_drifts_;
    map_.move_bodies(
        bodies_of_domains_, x, length, q_moved_, x_end_, is_last ? &moved_ : nullptr);
    return true;
}

void Stepper::kick_between_drifts() {
    // What ends one drift and begins the next, in one go.
    const double damped = 1 / (1 + scene_.solver.damping * dt_hat_), kept = damped * damped,
                 kick = dt_hat_ * (damped + kept);
    for (std::size_t i = 0; i < inner_gradient_.size(); ++i)
        inner_gradient_[i] += gradient_before_[prescribed_.corners[i]];
    const auto kicked = [&](int i, const Vec3p& force) {
        return kept * q_moved_[i] + (kick * inverse_mass_[i]) * force;
    };
    for_chunks(map_.n_free(), chunk, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const int c = map_.free_corner()[i];
            q_moved_[i] = kicked(i, assembly_.force[c] - gradient_before_[c]);
        }
    });
    gather_forces_at_nodes(gradient_before_);
    for (int i = map_.n_free(); i < map_.n_dofs(); ++i)
        q_moved_[i] = kicked(i, node_force_[i] - (has_points_ ? grid_gradient_[i] : Vec3p{}));
    hold_prescribed();
}

void Stepper::gather_forces_at_nodes(const Field& gradient) {
    // Of domains. What acts on points from outside stays as it was at the start of the step.
    for (std::size_t b = 0; b < points_.size(); ++b)
        if (!points_[b])
            map_.gather_at_nodes(static_cast<int>(b), assembly_.force, gradient, node_force_);
}

bool Stepper::has_kept_way(const Field& x, bool of_points) const {
    // The length of the step was chosen by speeds at its start.
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        if ((points_[b] != nullptr) != of_points)
            continue;
        const CornerMap::BodyRange& range = ranges_[b];
        double squared = 0;
        for (int c = range.begin; c < range.end; ++c)
            squared = std::max(squared, dot(x_end_[c] - x[c], x_end_[c] - x[c]));
        if (squared > std::pow(cells_per_step * range.cell_size, 2))
            return false;
    }
    return true;
}

bool Stepper::is_clear_of_surfaces(const State& state, double dt) {
    // Several drifts know of no other body: where they end in one, the step is taken again by a shorter one.
    if (surfaces_.empty())
        return true;
    surfaces_.see_end(x_end_);
    surfaces_.begin_step({state.x, state.v, state.top_speed, state.contacts}, x_end_, dt);
    return !surfaces_.touches(x_end_);
}

double Stepper::restrain_by_colliders(const Field& x, double length) {
    double way = longest_way(length);
    const auto stops_there = [&](double least_depth) {
        map_.apply_at(colliders_.touching(way), q_moved_, moved_);
        return colliders_.stops(x, moved_, way, least_depth);
    };
    std::vector<ColliderContact::Stop> stops = stops_there(0);
    if (stops.empty())
        return 0;
    double deepest = 0;
    for (const ColliderContact::Stop& stop : stops)
        deepest = std::max(deepest, stop.depth);
    impulses_->begin_drift(length);
    for (int pass = 0; !stops.empty() && pass < contact_passes; ++pass) {
        for (const auto& [corner, depth, touch] : stops)
            impulses_->add(touch, impulses_->row_of(corner));
        const double change = length * impulses_->settle(q_moved_);
        if (change < depth_tolerance * colliders_.finest_edge())
            break;
        // What the impulses have brought inside, or still is where the collider's surface turns.
        way += change;
        stops = stops_there(depth_tolerance);
    }
    return deepest;
}

bool Stepper::restrain_by_surfaces(const State& state, double dt) {
    if (surfaces_.empty())
        return false;
    drift(state.x, dt);
    surfaces_.begin_step({state.x, state.v, state.top_speed, state.contacts}, x_end_, dt);
    if (surfaces_.finds_none())
        return false;
    double way = 0;  // of any corner that contact has changed in the last pass, at most
    for (int pass = 0; pass < contact_passes; ++pass) {
        // Found where the corners would end: again, as they end elsewhere once they are restrained.
        if (pass > 0
            && (surfaces_.is_linear_enough(x_end_, way, depth_tolerance)
                || surfaces_.relinearize(x_end_) < depth_tolerance))
            return true;
        const std::optional<double> change = surfaces_.restrain(*impulses_, q_moved_, moved_);
        if (!change && pass == 0)
            return false;
        way = dt * change.value_or(0);
        drift(state.x, dt);
    }
    return true;
}

double Stepper::second_kick(const Field& gradient_before) {
    // v_end_ becomes the new velocity of free corners; kick_nodes() writes that of slaves. It is set for every corner, as free
    // and slaved ones alternate so that a branch costs more. On the way the frequency of the motion.
    const double damped = 1 / (1 + scene_.solver.damping * dt_hat_), length = 2 * dt_hat_;
    v_end_.resize(moved_.size());
    Vec3p sums{};
    for (const AssembledBody& body : assembly_.bodies) {
        if (body.points)
            continue;  // kick_nodes(), seen_frequency_of_points()
        sums += sum_chunks(body.end - body.begin, chunk, [&](int begin, int end) {
            Vec3p force{}, strain{}, motion{};
            for (int c = body.begin + begin; c < body.begin + end; ++c) {
                const Vec3p& is_free = prescribed_.is_free[c];
                const double inverse_mass = assembly_.inverse_mass[c];
                const Vec3p dx = length * moved_[c];
                const Vec3p dg = (end_gradient_[c] - gradient_before[c]) * is_free;
                force += inverse_mass * dg * dg;
                strain += dx * dg;
                motion += assembly_.mass[c] * dx * dx;
                const Vec3p kick = dt_hat_ * (assembly_.force[c] - end_gradient_[c]);
                const Vec3p v = damped * (moved_[c] + inverse_mass * kick);
                v_end_[c] = moved_[c] + is_free * (v - moved_[c]);
            }
            return Vec3p{sum_of(force), sum_of(strain), sum_of(motion), 0};
        });
    }
    return frequency_of(sums);
}

double Stepper::frequency_of(const Vec3p& sums) const {
    const double force = sums[0], strain = sums[1], motion = sums[2];
    return strain * dt_hat_ * dt_hat_ > noise * motion ? std::sqrt(force / strain) : 0;
}

void Stepper::kick_nodes(const State& state, double dt) {
    const int n = map_.n_dofs();
    const auto& step = potential_.step();
    const double damped = 1 / (1 + scene_.solver.damping * dt_hat_);
    gather_forces_at_nodes(end_gradient_);
    for (int i = map_.n_free(); i < n; ++i) {
        const Vec3p inner = has_points_ ? grid_gradient_[i] : Vec3p{};
        const Vec3p v =
            damped * (q_moved_[i] + (dt_hat_ * inverse_mass_[i]) * (node_force_[i] - inner));
        q_moved_[i] += step.is_free[i] * (v - q_moved_[i]);
    }
    if (moves_grid_)
        return map_.apply_to_slaves(q_moved_, v_end_);
    // Slaves keep of their velocity what a grid at rest could not see (FLIP): v = T q + unseen (v_n - T q_n), in one go.
    const double undamped = std::pow(damped, 2 * n_drifts_);
    const Memory memory{0, undamped, undamped * share_kept(dt)};  // kicks act at both ends
    const std::vector<Vec3p> gained = gained_by_nodes(memory);
    for (int i = map_.n_free(); i < n; ++i)
        q_n_[i] = q_moved_[i] - memory.unseen * q_n_[i];
    map_.apply_to_slaves(q_n_, v_end_);
    return_to_slaves(state.x, state.v, memory, gained, v_end_);
}

void Stepper::set_explicit_reactions(const State& state, double dt) {
    // Force of the pin on a corner: m (dv/dt + damping v) - f + ∂Φ/∂x, by the mean along the step. Only of pinned corners.
    reaction_.resize(state.x.size());
    for (std::size_t i = 0; i < prescribed_.corners.size(); ++i) {
        const int c = prescribed_.corners[i];
        const Vec3p v = (x_end_[c] - state.x[c]) / dt;
        const Vec3p inertia =
            assembly_.mass[c] * ((v_end_[c] - state.v[c]) / dt + scene_.solver.damping * v);
        const Vec3p gradient =
            (0.5 * (gradient_[c] + end_gradient_[c]) + inner_gradient_[i]) / n_drifts_;
        reaction_[c] = (inertia - assembly_.force[c] + gradient)
                       * (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]);
    }
    const double damped = std::pow(1 + scene_.solver.damping * dt_hat_, 2 * n_drifts_);
    set_node_reactions([&](int k, int i) {
        const Vec3p change = damped * q_moved_[i] - q_n_[i];
        const Vec3p inner = inner_at_nodes_[k] / double(n_drifts_);
        return dof_mass_[i] * change / dt - node_force_[i] + inner;
    });
}

}  // namespace sim
