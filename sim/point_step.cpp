// What material points and affine transfers add to a step.
#include "sim/base/parallel.h"
#include "sim/stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

constexpr int chunk = 8192;
constexpr double cells_between_parts = 0.6;  // by which two may near each other in a step

/// The gradient of a rotation, [spin]x.
Gradient change_by(const Vec3p& spin) {
    Gradient result;
    for (int j = 0; j < 3; ++j)
        result.column[j] = cross(spin, padded(Vec3(Vec3::Unit(j))));
    return result;
}

}  // namespace

std::vector<GridEnergy*> Stepper::make_points() {
    std::vector<GridEnergy*> energies;
    for (std::size_t b = 0; b < assembly_.bodies.size(); ++b) {
        const AssembledBody& body = assembly_.bodies[b];
        points_.emplace_back(
            body.points ? new PointEnergy(
                map_, static_cast<int>(b), body.begin, body.cell_size, *body.points)
                        : nullptr);
        has_points_ |= points_.back() != nullptr;
        if (points_.back())
            energies.push_back(points_.back().get());
    }
    return energies;
}

void Stepper::start(State& state) {
    for (const AssembledBody& body : assembly_.bodies)
        state.points.emplace_back(body.points ? body.points->size() : 0);
    if (scene_.solver.transfer != Transfer::Apic)
        return;
    state.affine.resize(state.x.size());
    for (std::size_t b = 0; b < ranges_.size(); ++b)
        std::fill(state.affine.begin() + ranges_[b].begin,
                  state.affine.begin() + ranges_[b].end,
                  change_by(padded(scene_.bodies[b].spin)));
}

void Stepper::add_affine_momentum(const State& state) {
    // Node i gets Σ_p w_ip m_p C_p (x_i - x_p). [JSS15 eq. 8] has B_p D_p⁻¹ with D where the point is now: the same but for
    // linear kernels, whose D changes on the way, so that B of a rigid rotation would be another one the next time.
    for (std::size_t b = 0; b < assembly_.bodies.size(); ++b)
        map_.add_transposed(
            static_cast<int>(b),
            CornerMap::Factor::Moment,
            [&](const CornerMap::Slaves& at, Gradient* values) {
                for (int s = at.begin; s < at.end; ++s) {
                    const int c = map_.slave_corner()[s];
                    for (int j = 0; j < 3; ++j)
                        values[s - at.begin].column[j] =
                            assembly_.mass[c] * state.affine[c].column[j];
                }
            },
            q_n_);
}

void Stepper::commit_affine(State& state, const Field& q) const {
    // A corner that is free may be slaved next: its surroundings turn with the body.
    if (state.affine.empty())
        return;
    for (const int c : map_.free_corner())
        state.affine[c] = change_by(rigid_[assembly_.body_of(c)].spin);
    for (std::size_t b = 0; b < assembly_.bodies.size(); ++b) {
        // B D⁻¹ of linear kernels is their slope, also on a face of cells, where both B and D vanish.
        const bool is_linear = ranges_[b].kernel == Kernel::Linear;
        const double inverse_D = is_linear ? 1 : 1 / map_.second_moment(static_cast<int>(b));
        map_.visit_gradients(static_cast<int>(b),
                             is_linear ? CornerMap::Factor::Slope : CornerMap::Factor::Moment,
                             q,
                             [&](const CornerMap::Slaves& at, Gradient* values) {
                                 for (int s = at.begin; s < at.end; ++s)
                                     for (int j = 0; j < 3; ++j)
                                         state.affine[map_.slave_corner()[s]].column[j] =
                                             inverse_D * values[s - at.begin].column[j];
                             });
    }
}

Stepper::BeyondCorners Stepper::affine_motion(const State& state) const {
    BeyondCorners sum;
    for (std::size_t b = 0; b < ranges_.size() && !state.affine.empty(); ++b) {
        const CornerMap::Slaves slaves = map_.slaves_of(static_cast<int>(b));
        const double D = map_.second_moment(static_cast<int>(b));
        for (int s = slaves.begin; s < slaves.end; ++s) {
            const int c = map_.slave_corner()[s];
            const double moment = assembly_.mass[c][0] * D;
            for (int j = 0; j < 3; ++j) {
                const Vec3p& C = state.affine[c].column[j];
                sum.energy += moment / 2 * dot(C, C);
                sum.angular_momentum += moment * Vec3::Unit(j).cross(unpadded(C));
            }
        }
    }
    return sum;
}

void Stepper::set_node_reactions(const std::function<Vec3p(int, int)>& force_on) {
    node_reactions_.clear();
    for (std::size_t k = 0; k < pinned_nodes_.size(); ++k) {
        const PinnedNode& node = pinned_nodes_[k];
        const Vec3p force =
            force_on(static_cast<int>(k), node.dof) * (Vec3p{1, 1, 1, 0} - node.is_free);
        node_reactions_.push_back(
            {node.holder, unpadded(map_.dof_position()[node.dof]), unpadded(force)});
    }
}

void Stepper::add_start_gradient(Field& gradient) {
    for (const auto& points : points_)
        if (points)
            points->add_start_gradient(gradient);
}

double Stepper::end_drift(const Field& x_n, double length) {
    for (int i = map_.n_free(); i < map_.n_dofs(); ++i)
        way_[i] += length * q_moved_[i];
    if (!has_points_)
        return 0;
    std::swap(grid_gradient_, grid_gradient_before_);
    grid_gradient_.assign(map_.n_dofs(), Vec3p{});
    double energy = 0;
    for (const auto& points : points_)
        if (points)
            energy += points->end_drift(way_, x_n, x_end_, grid_gradient_);
    return energy;
}

void Stepper::add_at_pinned_nodes(double share) {
    for (std::size_t k = 0; k < pinned_nodes_.size() && has_points_; ++k)
        inner_at_nodes_[k] += share * grid_gradient_[pinned_nodes_[k].dof];
}

double Stepper::seen_frequency_of_points() {
    // As for corners, on the degrees of freedom: how their inner forces change over the way dt q.
    const Field& is_free = potential_.step().is_free;
    if (!has_points_)
        return 0;
    const Vec3p sums =
        sum_chunks(map_.n_dofs() - map_.n_free(), chunk, [&](int begin, int end) {
            Vec3p sum{};
            for (int i = map_.n_free() + begin; i < map_.n_free() + end; ++i) {
                const Vec3p dx = 2 * dt_hat_ * q_moved_[i];
                const Vec3p dg = (grid_gradient_[i] - grid_gradient_before_[i]) * is_free[i];
                sum += Vec3p{
                    dot(dg, dg) * inverse_mass_[i], dot(dx, dg), dof_mass_[i] * dot(dx, dx), 0};
            }
            return sum;
        });
    return frequency_of(sums);
}

double Stepper::relative_limit(const State& state) const {
    // Parts that near each other by more than a cell would not see each other on the grid. Within a body of points, and
    // between it and others, speeds are those about the mean of each body.
    const std::size_t n = assembly_.bodies.size();
    if (!has_points_)
        return std::numeric_limits<double>::infinity();
    std::vector<Vec3p> mean(n);
    std::vector<double> deviation(n, 0);
    for (std::size_t b = 0; b < n; ++b) {
        const int begin = ranges_[b].begin, end = ranges_[b].end;
        for (int c = begin; c < end; ++c)
            mean[b] += state.v[c];
        mean[b] /= double(end - begin);
        double squared = 0;
        for (int c = begin; c < end; ++c)
            squared = std::max(squared, dot(state.v[c] - mean[b], state.v[c] - mean[b]));
        deviation[b] = std::sqrt(squared);
    }
    double limit = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b) {
            if (!points_[a])
                continue;
            const Vec3p between = mean[a] - mean[b];
            const double speed = std::sqrt(dot(between, between)) + deviation[a] + deviation[b];
            limit = std::min(limit, cells_between_parts * ranges_[a].cell_size / speed);
        }
    return limit;
}

}  // namespace sim
