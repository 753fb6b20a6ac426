#include "sim/contact/moving_collider.h"

#include "sim/contact/collider_field.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

using Distance = MovingCollider::Distance;

constexpr double infinity = std::numeric_limits<double>::infinity();

Distance distance_to(const PlaneShape& plane, const Vec3& x) {
    const Vec3 n = plane.normal.normalized();
    return {(x - plane.point).dot(n), n};
}

/// Away from a point at a distance; up where there is no direction.
Distance away_from(const Vec3& point, double radius, const Vec3& x) {
    const Vec3 r = x - point;
    const double length = r.norm();
    return {length - radius, length > 0 ? Vec3(r / length) : Vec3(0, 0, 1)};
}

Distance distance_to(const assets::Sphere& sphere, const Vec3& x) {
    return away_from(sphere.center, sphere.radius, x);
}

Distance distance_to(const assets::Capsule& capsule, const Vec3& x) {
    const Vec3 axis = capsule.to - capsule.from;
    const double along = (x - capsule.from).dot(axis) / std::max(axis.squaredNorm(), 1e-300);
    return away_from(capsule.from + std::clamp(along, 0.0, 1.0) * axis, capsule.radius, x);
}

Distance distance_to(const assets::Box& box, const Vec3& x) {
    const Vec3 nearest = x.cwiseMax(box.min).cwiseMin(box.max);
    if (nearest != x)
        return away_from(nearest, 0, x);
    // Inside: out through the nearest face.
    Distance inside{-infinity, {}};
    for (int k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            const double gap = side > 0 ? x[k] - box.max[k] : box.min[k] - x[k];
            if (gap > inside.gap)
                inside = {gap, side * Vec3::Unit(k)};
        }
    return inside;
}

Distance distance_to(const assets::Cylinder& cylinder, const Vec3& x) {
    const Vec3 axis = cylinder.to - cylinder.from, unit = axis.normalized();
    const double height = (x - cylinder.from).dot(unit);
    const Vec3 foot = cylinder.from + height * unit;
    const Distance side = away_from(foot, cylinder.radius, x);
    const Distance end = height > axis.norm() / 2 ? Distance{height - axis.norm(), unit}
                                                  : Distance{-height, -unit};
    if (side.gap <= 0 || end.gap <= 0)
        return side.gap > end.gap ? side : end;
    // Beyond the rim: from its nearest point.
    const Vec3 rim = foot + cylinder.radius * side.normal - end.gap * end.normal;
    return away_from(rim, 0, x);
}

Distance distance_to(const assets::Torus& torus, const Vec3& x) {
    const Vec3 axis = torus.axis.normalized(), r = x - torus.center;
    const Vec3 flat = r - r.dot(axis) * axis;
    const Vec3 out = flat.norm() > 0 ? Vec3(flat.normalized()) : axis.unitOrthogonal();
    return away_from(torus.center + torus.major * out, torus.minor, x);
}

Distance distance_to(const std::shared_ptr<const assets::DistanceField>& field, const Vec3& x) {
    Distance distance;
    distance.gap = field->at(x, distance.normal);
    return distance;
}

/// Whether the distance and its gradient are those of a formula.
template <class Kind>
concept HasFormula = requires(const Kind& kind, const Vec3& x) {
    distance_to(kind, x);
};

}  // namespace

assets::Source collider_source(const Collider& collider) {
    assets::Source source;
    if (const auto* mesh = std::get_if<assets::MeshFile>(&collider.shape))
        source.geometry = *mesh;
    else
        source.geometry = std::get<assets::Shape>(collider.shape);
    return source;
}

MovingCollider::MovingCollider(const Collider& collider, double resolution, double reach)
    : keys_(collider.keys), friction_(collider.friction) {
    if (const auto* plane = std::get_if<PlaneShape>(&collider.shape)) {
        shape_ = *plane;
        thickness_ = infinity;
        return;
    }
    const assets::Source source = collider_source(collider);
    const auto solid = assets::make_solid(source, resolution / 4, resolution / 4);
    pivot_ = collider.pivot.value_or((solid->min + solid->max) / 2);
    thickness_ = (solid->max - solid->min).minCoeff();
    bool has_formula = false;
    if (const auto* shape = std::get_if<assets::Shape>(&collider.shape))
        has_formula = std::visit(
            [&](const auto& kind) {
                constexpr bool is_formula = HasFormula<std::decay_t<decltype(kind)>>;
                if constexpr (is_formula)
                    shape_ = kind;
                return is_formula;
            },
            *shape);
    if (has_formula)
        return;
    const ColliderField field = collider_field(source, *solid, resolution, reach);
    shape_ = field.distance;
    if (field.voxel < resolution / 4)  // made finer for walls that are no thinner than that
        thickness_ = std::min(thickness_, 1.5 * field.voxel);
}

Pose MovingCollider::pose(double time) const {
    Pose pose;
    pose.pivot = pivot_;
    if (keys_.empty())
        return pose;
    const auto after = std::find_if(
        keys_.begin(), keys_.end(), [&](const ColliderKey& key) { return key.time > time; });
    const ColliderKey& to = after == keys_.end() ? keys_.back() : *after;
    const ColliderKey& from = after == keys_.begin() ? to : *(after - 1);
    const double t = to.time > from.time ? (time - from.time) / (to.time - from.time) : 1;
    const double share = std::clamp(t, 0.0, 1.0);
    pose.translate = from.translate + share * (to.translate - from.translate);
    pose.R = assets::rotation(from.rotate + share * (to.rotate - from.rotate));
    return pose;
}

Distance MovingCollider::distance(const Vec3& X) const {
    return std::visit([&](const auto& shape) { return distance_to(shape, X); }, shape_);
}

}  // namespace sim
