// A grid that moves along with bodies: its map is kept until pins change.
#include "assets/base/error.h"
#include "sim/mapped_frequency.h"
#include "sim/stepper.h"

#include <algorithm>

namespace sim {

namespace {

// Of the frequency of corners, at least: near the limit of modes that move much, drifts ripple the energy.
constexpr double least_slowed = 0.9;

}  // namespace

void Stepper::keep_map(State& state, const Field& x_hat) {
    // Corners keep their cells, so which of them are free changes with the pins alone.
    if (state.grid.made_at.empty() || state.grid.held != prescribed_.corners)
        renew_map(state);
    place_nodes(state, x_hat);
}

bool Stepper::has_other_pins(int b, const MovingGrid& grid) const {
    const auto in_body = [&](const std::vector<int>& corners) {
        std::vector<int> result;
        for (const int c : corners)
            if (c >= ranges_[b].begin && c < ranges_[b].end)
                result.push_back(c);
        return result;
    };
    return in_body(grid.held) != in_body(prescribed_.corners);
}

void Stepper::renew_map(State& state) {
    MovingGrid& grid = state.grid;
    const bool is_first = grid.made_at.empty();
    free_ = is_first ? std::vector<char>(state.x.size(), 0) : grid.free;
    grid.made_at.resize(state.x.size());
    std::vector<CornerMap::Nodes> before(ranges_.size());
    std::vector<char> changes(ranges_.size(), 1);
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        if (!is_first) {
            before[b] = map_.nodes_of(static_cast<int>(b));
            changes[b] = has_other_pins(static_cast<int>(b), grid);
        }
        if (!changes[b])
            continue;
        std::copy(state.x.begin() + ranges_[b].begin,
                  state.x.begin() + ranges_[b].end,
                  grid.made_at.begin() + ranges_[b].begin);
        choose_free_corners(static_cast<int>(b), state.x);
    }
    grid.free = free_;
    grid.held = prescribed_.corners;
    map_.rebuild(grid.made_at, free_, ranges_);
    measure_frequencies(changes);

    // Nodes of other bodies keep what they have.
    const auto nodes_of = [&](const Field& dofs, const Field& kept) {
        Field nodes(dofs.begin() + map_.n_free(), dofs.end());
        for (std::size_t b = 0; b < before.size(); ++b)
            if (!changes[b])
                std::copy(kept.begin() + before[b].begin,
                          kept.begin() + before[b].end,
                          nodes.begin() + map_.nodes_of(static_cast<int>(b)).begin);
        return nodes;
    };
    grid.x = nodes_of(map_.dof_position(), grid.x);
    map_.place(state.x, grid.x);
    lift(state, state.x, state.v);
    grid.v = nodes_of(q_n_, grid.v);
    grid.x_before.clear();
    grid.v_before.clear();
}

void Stepper::measure_frequencies(const std::vector<char>& changes) {
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        const CornerMap::Slaves slaves = map_.slaves_of(static_cast<int>(b));
        if (!changes[b] || scene_.solver.steps != Steps::Explicit)
            continue;
        AssembledBody& body = assembly_.bodies[b];
        highest_frequency_[b] = body.highest_frequency;
        if (body.method == Method::Enriched && slaves.begin < slaves.end)
            highest_frequency_[b] *= std::max(
                least_slowed,
                highest_frequency(
                    *body.elasticity, body.lattice, map_, static_cast<int>(b), body.begin)
                    / body.highest_frequency);
    }
}

void Stepper::place_nodes(const State& state, const Field& x_hat) {
    // Where nodes are as the scheme sees them, and how fast.
    const MovingGrid& grid = state.grid;
    const std::size_t n = grid.x.size();
    Field x = grid.x;
    node_v_hat_ = grid.v;
    if (history_ != 0 && !grid.x_before.empty()) {
        for (std::size_t i = 0; i < n; ++i) {
            x[i] += history_ * (grid.x[i] - grid.x_before[i]);
            node_v_hat_[i] += history_ * (grid.v[i] - grid.v_before[i]);
        }
    } else if (history_ != 0) {  // as the corners around them
        map_.place(state.x, grid.x);
        add_lifted(state, x_hat, state.x, x);
        add_lifted(state, v_hat_, state.v, node_v_hat_);
    }
    map_.place(x_hat, x);
}

void Stepper::add_lifted(const State& state,
                         const Field& end,
                         const Field& start,
                         Field& nodes) {
    Field change(end.size());
    for (std::size_t c = 0; c < change.size(); ++c)
        change[c] = end[c] - start[c];
    lift(state, state.x, change);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        nodes[i] += q_n_[map_.n_free() + i];
}

void Stepper::end_grid(State& state) {
    MovingGrid& grid = state.grid;
    if (scene_.solver.steps == Steps::Bdf2) {
        grid.x_before = grid.x;
        grid.v_before = grid.v;
    }
    for (std::size_t i = 0; i < grid.x.size(); ++i) {
        const int dof = map_.n_free() + static_cast<int>(i);
        grid.x[i] =
            map_.dof_position()[dof] + way_[dof] + dt_hat_ * shift_[map_.dof_body()[dof]];
        grid.v[i] = q_moved_[dof] + shift_[map_.dof_body()[dof]];
    }
}

Stepper::BeyondCorners Stepper::node_motion(const State& state) const {
    BeyondCorners sum;
    const auto add = [&](double mass, const Vec3p& x, const Vec3p& v) {
        sum.energy += mass / 2 * dot(v, v);
        sum.angular_momentum += mass * unpadded(cross(x, v));
    };
    if (!moves_grid_)
        return sum;
    for (std::size_t i = 0; i < state.grid.x.size(); ++i)
        add(dof_mass_[map_.n_free() + i], state.grid.x[i], state.grid.v[i]);
    for (const int c : map_.slave_corner())
        add(-assembly_.mass[c][0], state.x[c], state.v[c]);
    return sum;
}

void Stepper::restore_map(const State& state) {
    if (!moves_grid_)
        return;
    map_.rebuild(state.grid.made_at, state.grid.free, ranges_);
    measure_frequencies(std::vector<char>(ranges_.size(), 1));
    assets::check(static_cast<int>(state.grid.x.size()) == map_.n_dofs() - map_.n_free(),
                  "checkpoint has the nodes of its map");
    lift(state, state.x, state.v);  // mass
}

}  // namespace sim
