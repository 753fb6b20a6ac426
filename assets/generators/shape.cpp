#include "assets/generators/shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace assets {

namespace {

/// A point in cylindrical coordinates about an axis through `point`.
struct AxisCoordinates {
    double height = 0, radius = 0;  // [m]
};

AxisCoordinates about_axis(const Vec3& x, const Vec3& point, const Vec3& unit_axis) {
    const Vec3 d = x - point;
    const double height = d.dot(unit_axis);
    return {height, (d - height * unit_axis).norm()};
}

/// Length of the part of `direction` across a unit axis.
double across(const Vec3& direction, const Vec3& unit_axis) {
    return (direction - direction.dot(unit_axis) * unit_axis).norm();
}

double distance_of(const Box& box, const Vec3& x) {
    const Vec3 beyond = (box.min - x).cwiseMax(x - box.max);
    return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
}

double distance_of(const Sphere& sphere, const Vec3& x) {
    return (x - sphere.center).norm() - sphere.radius;
}

double distance_of(const Cylinder& cylinder, const Vec3& x) {
    const Vec3 axis = cylinder.to - cylinder.from;
    const AxisCoordinates at = about_axis(x, cylinder.from, axis.normalized());
    const double past_side = at.radius - cylinder.radius;
    const double past_end = std::max(-at.height, at.height - axis.norm());
    return std::hypot(std::max(past_side, 0.0), std::max(past_end, 0.0))
           + std::min(0.0, std::max(past_side, past_end));
}

double distance_of(const Capsule& capsule, const Vec3& x) {
    const Vec3 axis = capsule.to - capsule.from;
    const double length_squared = axis.squaredNorm();
    const double along = length_squared > 0 ? (x - capsule.from).dot(axis) / length_squared : 0;
    return (x - capsule.from - std::clamp(along, 0.0, 1.0) * axis).norm() - capsule.radius;
}

double distance_of(const Torus& torus, const Vec3& x) {
    const AxisCoordinates at = about_axis(x, torus.center, torus.axis.normalized());
    return std::hypot(at.radius - torus.major, at.height) - torus.minor;
}

/// The nearest point of an ellipsoid of radii e_i to x is y_i = e_i² x_i / (t + e_i²), where t puts it on the surface:
/// g(t) = Σ (e_i x_i / (t + e_i²))² - 1 = 0. In units of the smallest radius g falls and is convex for t > -1, so Newton's
/// method climbs to the root from where one term of the sum is 1. Its unknown is t + 1, exact where t comes close to -1.
double distance_of(const Ellipsoid& ellipsoid, const Vec3& x, double enough) {
    const Vec3 from_middle = (x - ellipsoid.center).cwiseAbs();
    const double at_least = std::max(from_middle.norm() - ellipsoid.radii.maxCoeff(),
                                     (from_middle - ellipsoid.radii).maxCoeff());
    if (at_least >= enough)
        return at_least;
    constexpr int most_steps = 50;
    constexpr double least = 1e-12;  // keeps the nearest point unique in planes of symmetry
    const double unit = ellipsoid.radii.minCoeff();
    const Vec3 radii = ellipsoid.radii / unit;
    const Vec3 beyond = (radii.array() - 1) * (radii.array() + 1);  // e_i² - 1
    const Vec3 at = (from_middle / unit).cwiseMax(least);
    const Vec3 weighted = radii.cwiseProduct(at);
    double t_plus_1 = (weighted - beyond).maxCoeff();
    for (int step = 0; step < most_steps; ++step) {
        const Vec3 inverse = (beyond.array() + t_plus_1).inverse();
        const Vec3 squared_terms = weighted.cwiseProduct(inverse).cwiseAbs2();
        const double g = squared_terms.sum() - 1;
        const double next = t_plus_1 + g / (2 * squared_terms.dot(inverse));
        if (!(next > t_plus_1))
            break;
        t_plus_1 = next;
    }
    const Vec3 nearest = radii.array() * weighted.array() / (beyond.array() + t_plus_1);
    return std::copysign((at - nearest).norm(), t_plus_1 - 1) * unit;
}

/// min(a, b), less by up to k/4 where they differ by less than k: a fillet between two surfaces, slope 1 at most.
double smooth_min(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0);
    return std::min(a, b) - (k > 0 ? h * h / (4 * k) : 0);
}

/// What its bounds alone tell, at most the distance.   [m]
double least_distance(const Operand& operand, const Vec3& x) {
    return (operand.low - x).cwiseMax(x - operand.high).maxCoeff();
}

double distance_up_to(const Operand& operand, const Vec3& x, double enough) {
    const double least = least_distance(operand, x);
    return least >= enough ? least : assets::distance_up_to(operand.shape, x, enough);
}

/// Those whose bounds hold x first: they are most likely near, and hide others. Without fillets no order matters.
double distance_of_sharp_union(const std::vector<Operand>& of, const Vec3& x, double enough) {
    double distance = std::numeric_limits<double>::infinity();
    for (const bool holds : {true, false})
        for (const Operand& operand : of)
            if ((least_distance(operand, x) <= 0) == holds)
                distance =
                    std::min(distance, distance_up_to(operand, x, std::min(enough, distance)));
    return distance;
}

double distance_of(const Combination& combination, const Vec3& x, double enough) {
    using Kind = Combination::Kind;
    const double smooth = combination.smooth;
    const bool of_union = combination.kind == Kind::Union;
    if (of_union && smooth == 0)
        return distance_of_sharp_union(combination.of, x, enough);
    // What is not known exactly must hide behind the rest: a fillet reaches `smooth` and takes a quarter of it, each time.
    if (of_union)
        enough += 1.25 * static_cast<double>(combination.of.size()) * smooth;
    double distance = distance_up_to(combination.of.front(), x, enough);
    for (std::size_t i = 1; i < combination.of.size(); ++i) {
        const Operand& operand = combination.of[i];
        if (!of_union && distance >= enough)  // the others can but add to it
            return distance;
        if (of_union)
            distance =
                smooth_min(distance,
                           distance_up_to(operand, x, std::min(enough, distance + smooth)),
                           smooth);
        else if (combination.kind == Kind::Intersection)
            distance = -smooth_min(-distance, -distance_up_to(operand, x, enough), smooth);
        else
            distance =
                -smooth_min(-distance, distance_up_to(operand, x, smooth - distance), smooth);
    }
    return distance;
}

double distance_of(const Copies& copies, const Vec3& x, double enough) {
    double distance = std::numeric_limits<double>::infinity();
    for (const auto& [Q, t] : copies.to_original)
        distance = std::min(
            distance, distance_up_to(copies.of.front(), Q * x + t, std::min(enough, distance)));
    return distance;
}

double support_of(const Box& box, const Vec3& direction) {
    return direction.cwiseProduct(box.min).cwiseMax(direction.cwiseProduct(box.max)).sum();
}

double support_of(const Sphere& sphere, const Vec3& direction) {
    return direction.dot(sphere.center) + sphere.radius * direction.norm();
}

double support_of(const Cylinder& cylinder, const Vec3& direction) {
    const Vec3 axis = (cylinder.to - cylinder.from).normalized();
    return std::max(direction.dot(cylinder.from), direction.dot(cylinder.to))
           + cylinder.radius * across(direction, axis);
}

double support_of(const Capsule& capsule, const Vec3& direction) {
    return std::max(direction.dot(capsule.from), direction.dot(capsule.to))
           + capsule.radius * direction.norm();
}

double support_of(const Torus& torus, const Vec3& direction) {
    return direction.dot(torus.center)
           + torus.major * across(direction, torus.axis.normalized())
           + torus.minor * direction.norm();
}

double support_of(const Ellipsoid& ellipsoid, const Vec3& direction) {
    return direction.dot(ellipsoid.center) + direction.cwiseProduct(ellipsoid.radii).norm();
}

double support_of(const Combination& combination, const Vec3& direction) {
    using Kind = Combination::Kind;
    double bound = support(combination.of.front().shape, direction);
    if (combination.kind == Kind::Difference)
        return bound;
    for (std::size_t i = 1; i < combination.of.size(); ++i) {
        const double other = support(combination.of[i].shape, direction);
        bound =
            combination.kind == Kind::Union ? std::max(bound, other) : std::min(bound, other);
    }
    // A fillet of a union adds a quarter of `smooth` at most; many in one place less than `smooth` together.
    const double n_fillets =
        std::min<double>(static_cast<double>(combination.of.size()) - 1, 4);
    const double swell =
        combination.kind == Kind::Union ? n_fillets * combination.smooth / 4 : 0;
    return bound + swell * direction.norm();
}

double support_of(const Copies& copies, const Vec3& direction) {
    double bound = -std::numeric_limits<double>::infinity();
    for (const auto& [Q, t] : copies.to_original) {
        const Vec3 of_original = Q * direction;
        bound =
            std::max(bound, support(copies.of.front().shape, of_original) - of_original.dot(t));
    }
    return bound;
}

}  // namespace

Operand::Operand(Shape of) : shape(std::move(of)) {
    constexpr double rounding = 1e-9;  // of the extent
    for (int axis = 0; axis < 3; ++axis) {
        high[axis] = support(shape, Vec3::Unit(axis));
        low[axis] = -support(shape, -Vec3::Unit(axis));
    }
    const Vec3 wider = rounding * (high - low).cwiseAbs();
    low -= wider;
    high += wider;
}

Copies moved(const Shape& shape, const Vec3& rotate, const Vec3& translate) {
    const Mat3 Q = rotation(rotate).transpose();
    return {{{shape}}, {{Q, -(Q * translate)}}};
}

Copies mirrored(const Shape& shape, const Vec3& point, const Vec3& normal) {
    const Vec3 n = normal.normalized();
    const Mat3 Q = Mat3::Identity() - 2 * n * n.transpose();
    return {{{shape}}, {{}, {Q, point - Q * point}}};
}

Copies ring_of(const Shape& shape, const Vec3& point, const Vec3& axis, int count) {
    Copies copies{{{shape}}, {}};
    for (int i = 0; i < count; ++i) {
        const double back = -2 * EIGEN_PI * i / count;
        const Mat3 Q = Eigen::AngleAxisd(back, axis.normalized()).toRotationMatrix();
        copies.to_original.push_back({Q, point - Q * point});
    }
    return copies;
}

Mat3 rotation(const Vec3& angle) {
    return (Eigen::AngleAxisd(angle.z(), Vec3::UnitZ())
            * Eigen::AngleAxisd(angle.y(), Vec3::UnitY())
            * Eigen::AngleAxisd(angle.x(), Vec3::UnitX()))
        .toRotationMatrix();
}

Mat3 rotation(const Transform& transform) {
    return rotation(transform.rotate);
}

Vec3 apply(const Transform& transform, const Vec3& x) {
    return transform.translate + rotation(transform) * (transform.scale * x);
}

double distance_up_to(const Shape& shape, const Vec3& x, double enough) {
    return std::visit(
        [&](const auto& s) {
            if constexpr (requires { distance_of(s, x, enough); })
                return distance_of(s, x, enough);
            else
                return distance_of(s, x);
        },
        shape);
}

double signed_distance(const Shape& shape, const Vec3& x) {
    return distance_up_to(shape, x, std::numeric_limits<double>::infinity());
}

double support(const Shape& shape, const Vec3& direction) {
    return std::visit([&](const auto& s) { return support_of(s, direction); }, shape);
}

}  // namespace assets
