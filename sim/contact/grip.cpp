#include "sim/contact/grip.h"

namespace sim {

namespace {

constexpr double slip_speed = 1e-3;  // e / dt [m/s]
constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 tangential(const Vec3& u, const Vec3& normal) {
    return u - normal * normal.dot(u);
}

}  // namespace

Grip Grip::of(const Friction& friction,
              double stiffness,
              double depth,
              double dt,
              const Vec3& normal,
              const Vec3& origin) {
    Grip grip;
    const double slip_length = slip_speed * dt;
    const double force = friction.coefficient * stiffness * depth;
    if (!(depth > 0) || !(slip_length > 0) || !(friction.stick || force > 0))
        return grip;
    grip.normal = normal;
    grip.origin = origin;
    grip.force = friction.stick ? infinity : force;
    grip.slip_length = friction.stick ? infinity : slip_length;
    grip.stiffness = friction.stick ? stiffness : force / slip_length;
    return grip;
}

double Grip::add_gradient(const Vec3& u, Vec3& g) const {
    const Vec3 slip = tangential(u - origin, normal);
    const double y = slip.norm();
    const bool is_elastic = y < slip_length;
    g += (is_elastic ? stiffness : force / y) * slip;
    return is_elastic ? stiffness / 2 * y * y : force * (y - slip_length / 2);
}

Mat3 Grip::hessian(const Vec3& u) const {
    const Mat3 P = Mat3::Identity() - normal * normal.transpose();
    const Vec3 slip = P * (u - origin);
    const double y = slip.norm();
    if (y < slip_length)
        return stiffness * P;
    return force / y * (P - slip * slip.transpose() / (y * y));
}

}  // namespace sim
