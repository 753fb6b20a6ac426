#include "sim/report.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>

namespace sim {

namespace {

/// What a probe tells of a region, piece by piece; nothing where a region is thinner than a domain everywhere.
class RegionRow {
  public:
    void add(double rest_volume, double volume, const Mat3& F, const Vec3& at) {
        rest_volume_ += rest_volume;
        row_.volume += volume;
        row_.position += rest_volume * at;
        row_.stretch += rest_volume * Eigen::JacobiSVD<Mat3>(F).singularValues()[0];
    }

    ProbeRow row() const {
        ProbeRow row = row_;
        row.is_region = true;
        if (rest_volume_ > 0) {
            row.position /= rest_volume_;
            row.stretch /= rest_volume_;
        }
        return row;
    }

  private:
    ProbeRow row_;
    double rest_volume_ = 0;
};

ProbeRow region_row(const AssembledBody& body, int region, const std::vector<Vec3>& corners) {
    RegionRow sums;
    for (int p = 0; p < body.lattice.n_domains(); ++p) {
        if (body.lattice.region[p] != region)
            continue;
        Vec3 centre = Vec3::Zero();
        for (const int c : body.lattice.corners[p])
            centre += corners[c] / 8;
        const Mat3 F = deformation_gradient(body.lattice, p, corners);
        const double volume = body.lattice.domain_volume(p);
        sums.add(volume, volume * F.determinant(), F, centre);
    }
    return sums.row();
}

ProbeRow region_row(const AssembledBody& body,
                    int region,
                    const PointState& state,
                    const Vec3p* x) {
    RegionRow sums;
    const MaterialPoints& points = *body.points;
    for (int p = 0; p < points.size(); ++p) {
        if (points.region[p] != region)
            continue;
        const Eigen::Map<const Mat3> F(state.F[p].m);
        const double volume = points.volume[p];
        sums.add(volume, volume * F.determinant() * state.J_plastic[p], F, unpadded(x[p]));
    }
    return sums.row();
}

/// The point about which the moment of a pin is taken.
Vec3 moment_point(const Pin& pin, const AssembledPin& assembled, const Field& x) {
    if (const auto* spin = std::get_if<Pin::Spin>(&pin.moves))
        return spin->point;
    Vec3 sum = Vec3::Zero();
    for (const auto* held : {&assembled.corners, &assembled.points})
        for (const int c : *held)
            sum += unpadded(x[c]);
    return sum / static_cast<double>(assembled.corners.size() + assembled.points.size());
}

}  // namespace

std::vector<float> stretches(const PointState& state) {
    std::vector<float> result;
    for (const Matrix3<double>& F : state.F)
        result.push_back(static_cast<float>(
            Eigen::JacobiSVD<Mat3>(Eigen::Map<const Mat3>(F.m)).singularValues()[0]));
    return result;
}

std::vector<Vec3> corners_of(const AssembledBody& body, const Field& x) {
    std::vector<Vec3> corners(body.end - body.begin);
    for (std::size_t c = 0; c < corners.size(); ++c)
        corners[c] = unpadded(x[body.begin + c]);
    return corners;
}

Stats stats_of(Assembly& assembly, Stepper& stepper, const State& state) {
    Stats stats;
    stats.steps = stepper.steps;
    stats.newton_iterations = stepper.newton_iterations;
    stats.cg_iterations = stepper.cg_iterations;
    stats.total_mass = stepper.mass_on_dofs();
    for (std::size_t c = 0; c < state.x.size(); ++c) {
        const Vec3 x = unpadded(state.x[c]),
                   momentum = assembly.mass[c][0] * unpadded(state.v[c]);
        stats.kinetic_energy += 0.5 * momentum.dot(unpadded(state.v[c]));
        stats.gravitational_energy -= assembly.mass[c][0] * assembly.gravity.dot(x);
        stats.linear_momentum += momentum;
        stats.angular_momentum += x.cross(momentum);
    }
    for (const Stepper::BeyondCorners& beyond :
         {stepper.affine_motion(state), stepper.node_motion(state)}) {
        stats.kinetic_energy += beyond.energy;
        stats.angular_momentum += beyond.angular_momentum;
    }
    for (const HeldContact& contact : state.contacts)
        stats.elastic_energy += contact.energy;
    stats.collider_penetration =
        stepper.colliders().deepest_penetration(state.x, state.time).share;
    const SurfaceContact::Report contact = stepper.surfaces().report(state.x);
    stats.penetration = contact.penetration;
    stats.gap = contact.gap;
    Field gradient(state.x.size());
    stats.smallest_J = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < assembly.bodies.size(); ++b) {
        AssembledBody& body = assembly.bodies[b];
        if (body.points) {
            stats.elastic_energy +=
                stepper.points(static_cast<int>(b))->energy(state.points[b]);
            for (const Matrix3<double>& F : state.points[b].F)
                stats.smallest_J = std::min(stats.smallest_J, determinant(F));
            continue;
        }
        stats.elastic_energy +=
            body.elasticity->energy_and_gradient(&state.x[body.begin], &gradient[body.begin]);
        stats.smallest_J =
            std::min(stats.smallest_J, body.elasticity->smallest_J(&state.x[body.begin]).J);
    }
    return stats;
}

std::vector<ProbeRow> probes_of(const Scene& scene,
                                const Assembly& assembly,
                                const State& state) {
    std::vector<ProbeRow> rows;
    for (std::size_t k = 0; k < scene.probes.size(); ++k) {
        const AssembledProbe& probe = assembly.probes[k];
        const AssembledBody& body = assembly.bodies[probe.body];
        const std::vector<Vec3> corners = corners_of(body, state.x);
        ProbeRow row;
        if (body.points && probe.region >= 0)
            row =
                region_row(body, probe.region, state.points[probe.body], &state.x[body.begin]);
        else if (body.points)
            row.position = carried(probe.near, state.points[probe.body], &state.x[body.begin]);
        else if (probe.region >= 0)
            row = region_row(body, probe.region, corners);
        else
            row.position = carried(body.lattice, probe.point, corners);
        row.name = scene.probes[k].name;
        rows.push_back(row);
    }
    return rows;
}

std::vector<PinRow> pins_of(const Scene& scene,
                            const Assembly& assembly,
                            const Stepper& stepper,
                            const State& state) {
    std::vector<PinRow> rows;
    for (std::size_t k = 0; k < scene.pins.size(); ++k) {
        PinRow row;
        row.name = scene.pins[k].name;
        const Vec3 about = moment_point(scene.pins[k], assembly.pins[k], state.x);
        const auto add = [&](const HeldBy& holder, const Vec3& at, const Vec3& reaction) {
            Vec3 force = Vec3::Zero();
            for (int axis = 0; axis < 3; ++axis)
                if (holder[axis] == static_cast<int>(k))
                    force[axis] = reaction[axis];
            row.force += force;
            row.moment += (at - about).cross(force);
        };
        for (const int c : assembly.pins[k].corners)
            add(stepper.prescribed().holder[c],
                unpadded(state.x[c]),
                unpadded(stepper.reaction()[c]));
        for (const auto& [holder, at, reaction] : stepper.node_reactions())
            add(holder, at, reaction);
        rows.push_back(row);
    }
    return rows;
}

}  // namespace sim
