#include "sim/contact/grip.h"

#include <algorithm>

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

void Grip::linearize(const Vec3& u) {
    const Mat3 P = Mat3::Identity() - normal * normal.transpose();
    const Vec3 slip = P * (u - origin);
    const double y = slip.norm();
    // The w that the last linearisation asks for, shortened to the unit disc.
    if (const double y_before = slip_.norm(); y_before > 0) {
        const double most = std::max(y_before, slip_length);
        const bool slid = y_before >= slip_length;
        const Vec3 turn =
            slid ? Vec3(direction_ * (slip_.dot(slip - slip_) / most)) : Vec3::Zero();
        direction_ = (slip - turn) / most;
        direction_ /= std::max(1.0, direction_.norm());
    }
    slip_ = slip;
    if (y < slip_length) {
        hessian_ = stiffness * P;
        return;
    }
    const Mat3 turned = direction_ * slip.transpose() / y;
    hessian_ = force / y * (P - (turned + turned.transpose()) / 2);
}

}  // namespace sim
