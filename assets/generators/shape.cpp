#include "assets/generators/shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

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

}  // namespace

Mat3 rotation(const Transform& transform) {
    const Vec3& angle = transform.rotate;
    return (Eigen::AngleAxisd(angle.z(), Vec3::UnitZ())
            * Eigen::AngleAxisd(angle.y(), Vec3::UnitY())
            * Eigen::AngleAxisd(angle.x(), Vec3::UnitX()))
        .toRotationMatrix();
}

Vec3 apply(const Transform& transform, const Vec3& x) {
    return transform.translate + rotation(transform) * (transform.scale * x);
}

Vec3 apply_inverse(const Transform& transform, const Vec3& x) {
    return rotation(transform).transpose() * (x - transform.translate) / transform.scale;
}

double signed_distance(const Shape& shape, const Vec3& x) {
    return std::visit([&](const auto& s) { return distance_of(s, x); }, shape);
}

double support(const Shape& shape, const Vec3& direction) {
    return std::visit([&](const auto& s) { return support_of(s, direction); }, shape);
}

}  // namespace assets
