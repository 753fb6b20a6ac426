// What goes from corners to the degrees of freedom before they move, and comes back after.
#include "sim/base/parallel.h"
#include "sim/stepper.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int chunk = 8192;
// What does not turn about its own axis: a body no thicker than that, in cells.
constexpr double thin = 0.01;
// Each leaves a share as large as the angle that a step turns by.
constexpr int spin_passes = 3;

}  // namespace

void Stepper::transfer_to_nodes(const State& state,
                                const Field& x,
                                const Field& v,
                                const Field* inner) {
    // Mass and momentum of slaves to nodes: M = Tᵀ m, M q_n = Tᵀ (m v); free corners keep their own. Lumped means over the
    // corners around a node see a rotation too slow where corners lie on one side of it, so the body's rigid motion goes
    // over by its value at the node and only the rest by means: rigid motion is exact, and so is momentum, as
    // Σ_i w_ic x_i = x_c. APIC carries rotation by itself, and nodes that move along have kept what they had.
    if (moves_grid_) {
        q_n_.resize(map_.n_dofs());
        std::copy(node_v_hat_.begin(), node_v_hat_.end(), q_n_.begin() + map_.n_free());
        shift_.assign(ranges_.size(), Vec3p{});
    } else {
        lift(state, x, v);
    }
    for (int k = 0; k < map_.n_free(); ++k) {
        const int c = map_.free_corner()[k];
        dof_mass_[k] = assembly_.mass[c][0];
        inverse_mass_[k] = assembly_.inverse_mass[c];
    }
    transfer_forces(inner);
}

void Stepper::lift(const State& state, const Field& x, const Field& v) {
    const int n = map_.n_dofs();
    const bool is_affine = scene_.solver.transfer == Transfer::Apic;
    corner_.resize(state.x.size());
    rigid_.assign(ranges_.size(), RigidMotion{});
    shift_.assign(ranges_.size(), Vec3p{});
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        const CornerMap::Slaves slaves = map_.slaves_of(static_cast<int>(b));
        if (slaves.begin == slaves.end && !is_affine)
            continue;
        const CornerMap::BodyRange& range = ranges_[b];
        rigid_[b] =
            rigid_motion(assembly_.mass, x, v, range.begin, range.end, thin * range.cell_size);
        for_chunks(slaves.end - slaves.begin, chunk, [&](int begin, int end) {
            for (int s = slaves.begin + begin; s < slaves.begin + end; ++s) {
                const int c = map_.slave_corner()[s];
                const Vec3p& m = assembly_.mass[c];
                const Vec3p split = is_affine ? Vec3p{} : rigid_[b].at(x[c]);
                corner_[c] = m * (v[c] - split) + Vec3p{0, 0, 0, m[0]};  // mass in the fourth
            }
        });
    }
    q_n_.resize(n);
    for (std::size_t b = 0; b < ranges_.size(); ++b)
        map_.gather_at_nodes(static_cast<int>(b), corner_, q_n_);
    if (is_affine)
        add_affine_momentum(state);

    // A node that corners only touch with weight zero has no mass. It moves with the body at first: points on a node see
    // the slope of linear kernels all the same, so implicit steps put it where the stress asks for.
    dof_mass_.resize(n);
    inverse_mass_.resize(n);
    for (int i = map_.n_free(); i < n; ++i) {
        const double mass = q_n_[i][3];
        dof_mass_[i] = mass;
        inverse_mass_[i] = mass > 0 ? 1 / mass : 0;
        q_n_[i] = inverse_mass_[i] * q_n_[i] * Vec3p{1, 1, 1, 0};
        if (!is_affine || !(mass > 0))
            q_n_[i] += rigid_[map_.dof_body()[i]].at(map_.dof_position()[i]);
    }
}

void Stepper::transfer_forces(const Field* inner) {
    // What acts on slaves, to nodes. Forces of insides act on corners alone: those of points go to nodes by themselves.
    node_force_.resize(map_.n_dofs());
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        const AssembledBody& body = assembly_.bodies[b];
        if (body.points && body.has_weight_alone)
            continue;
        if (inner != nullptr && !body.points)
            map_.gather_at_nodes(static_cast<int>(b), assembly_.force, *inner, node_force_);
        else
            map_.gather_at_nodes(static_cast<int>(b), assembly_.force, node_force_);
    }
    const Vec3p gravity = padded(assembly_.gravity);
    for (int i = map_.n_free(); i < map_.n_dofs(); ++i) {
        const AssembledBody& body = assembly_.bodies[map_.dof_body()[i]];
        if (body.points && body.has_weight_alone)
            node_force_[i] = dof_mass_[i] * gravity;
    }
}

double Stepper::share_kept(double dt) const {
    // It fades at the rate of PIC: exp(-pic_rate dt) is kept per step, so that halving dt does not drain more (the paper
    // keeps 0.95 per step).
    return scene_.solver.transfer == Transfer::Apic ? 0
                                                    : std::exp(-scene_.solver.pic_rate * dt);
}

std::vector<Vec3p> Stepper::gained_by_nodes(const Memory& memory) const {
    std::vector<Vec3p> gained(ranges_.size());
    for (int i = map_.n_free(); i < map_.n_dofs(); ++i) {
        const int b = map_.dof_body()[i];
        const Vec3p arm = map_.dof_position()[i] - rigid_[b].centre;
        gained[b] += dof_mass_[i]
                     * (cross(arm + way_[i], q_moved_[i])
                        - memory.undamped * cross(arm + memory.way * way_[i], q_n_[i]));
    }
    return gained;
}

Vec3p Stepper::spin_for(const Vec3p& missing, int b, const Field& x_n) const {
    // spin × r has the angular momentum Σ m r' × (spin × r) = (tr S - S) spin, S = Σ m r r'ᵀ, with r' where corners end.
    const int first = ranges_[b].begin, last = ranges_[b].end;
    const RigidMotion& rigid = rigid_[b];
    Mat3 S = Mat3::Zero();
    for (int k = 0; k < 3; ++k) {
        const Vec3p column = sum_chunks(last - first, chunk, [&](int begin, int end) {
            Vec3p sum{};
            for (int c = first + begin; c < first + end; ++c)
                sum += assembly_.mass[c] * (x_end_[c][k] - rigid.centre[k])
                       * (x_n[c] - rigid.centre);
            return sum;
        });
        S.col(k) = unpadded(column);
    }
    const Mat3 A = S.trace() * Mat3::Identity() - S;
    Vec3 spin = Vec3::Zero();
    for (int pass = 0; pass < spin_passes; ++pass)
        spin += rigid.inverse_inertia * (unpadded(missing) - A * spin);
    return padded(spin);
}

void Stepper::return_to_slaves(const Field& x_n,
                               const Field& v_before,
                               const Memory& memory,
                               const std::vector<Vec3p>& gained,
                               Field& v) const {
    // Lumped means are blunt: of the angular momentum that nodes gain, slaves get a part. As rigid motion goes over to the
    // nodes by itself, what is missing comes back as rigid motion, and a free body keeps its angular momentum. To one that pins
    // hold the torque of their reactions would come back too, by more than the work done along the way of the step.
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        const CornerMap::Slaves slaves = map_.slaves_of(static_cast<int>(b));
        const RigidMotion& rigid = rigid_[b];
        const bool returns =
            scene_.solver.transfer == Transfer::Flip && !is_held(static_cast<int>(b));
        const auto gain = [&](int begin, int end) {
            Vec3p sum{};
            for (int s = slaves.begin + begin; s < slaves.begin + end; ++s) {
                const int c = map_.slave_corner()[s];
                v[c] += memory.unseen * v_before[c];
                if (!returns)
                    continue;
                const Vec3p arm = x_n[c] - rigid.centre, way = x_end_[c] - x_n[c];
                sum += assembly_.mass[c]
                       * (cross(arm + way, v[c] - shift_[b])
                          - memory.undamped * cross(arm + memory.way * way, v_before[c]));
            }
            return sum;
        };
        const Vec3p missing = gained[b] - sum_chunks(slaves.end - slaves.begin, chunk, gain);
        if (!returns || slaves.begin == slaves.end)
            continue;
        const Vec3p spin = spin_for(missing, static_cast<int>(b), x_n);
        for_chunks(ranges_[b].end - ranges_[b].begin, chunk, [&](int begin, int end) {
            for (int c = ranges_[b].begin + begin; c < ranges_[b].begin + end; ++c)
                v[c] += cross(spin, x_n[c] - rigid.centre);
        });
    }
}

}  // namespace sim
