#include "sim/contact/collider_contact.h"

#include "assets/generators/shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr double slip_speed = 1e-3;        // [m/s]
constexpr double stick_coefficient = 1e2;  // Coulomb coefficient that stands for "never slides"

struct Distance {
    double gap = 0;
    Vec3 normal{0, 0, 1};  // outward of the collider
};

Distance distance_to(const PlaneShape& plane, const Vec3& x) {
    const Vec3 n = plane.normal.normalized();
    return {(x - plane.point).dot(n), n};
}

Distance distance_to(const assets::Sphere& sphere, const Vec3& x) {
    const Vec3 r = x - sphere.center;
    const double length = r.norm();
    return {length - sphere.radius, length > 0 ? Vec3(r / length) : Vec3(0, 0, 1)};
}

Distance distance_to(const assets::Box& box, const Vec3& x) {
    const Vec3 nearest = x.cwiseMax(box.min).cwiseMin(box.max);
    const Vec3 r = x - nearest;
    const double length = r.norm();
    if (length > 0)
        return {length, r / length};
    // Inside: out through the nearest face.
    Distance inside{-std::numeric_limits<double>::infinity(), {}};
    for (int k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            const double gap = side > 0 ? x[k] - box.max[k] : box.min[k] - x[k];
            if (gap > inside.gap)
                inside = {gap, side * Vec3::Unit(k)};
        }
    return inside;
}

double coefficient(const Friction& friction) {
    return friction.stick ? stick_coefficient : friction.coefficient;
}

}  // namespace

ColliderContact::ColliderContact(std::vector<Collider> colliders,
                                 std::vector<ContactCorner> corners)
    : colliders_(std::move(colliders)), corners_(std::move(corners)) {
    lagged_normal_force_.assign(colliders_.size() * corners_.size(), 0.0);
}

template <class Visit>
void ColliderContact::for_touching(const Field& x, const Visit& visit) const {
    for (std::size_t k = 0; k < corners_.size(); ++k) {
        const ContactCorner& corner = corners_[k];
        const Vec3 position = unpadded(x[corner.corner]);
        for (std::size_t j = 0; j < colliders_.size(); ++j) {
            const std::size_t pair = k * colliders_.size() + j;
            const Distance distance =
                std::visit([&](const auto& shape) { return distance_to(shape, position); },
                           colliders_[j].shape);
            const double depth = std::max(0.0, -(distance.gap + corner.outside));
            const double friction_force =
                coefficient(colliders_[j].friction) * lagged_normal_force_[pair];
            if (depth > 0 || friction_force > 0)
                visit(Touch{corner.corner,
                            corner.stiffness,
                            distance.normal,
                            depth,
                            friction_force},
                      pair);
        }
    }
}

void ColliderContact::begin_step(const Field& x_n, double dt) {
    if (empty())
        return;
    x_n_ = x_n;
    slip_length_ = slip_speed * dt;
    std::vector<double> force(lagged_normal_force_.size(), 0.0);
    for_touching(x_n, [&](const Touch& touch, std::size_t pair) {
        force[pair] = touch.stiffness * touch.depth;
    });
    lagged_normal_force_ = std::move(force);
}

double ColliderContact::add_gradient(const Field& x, Field& gradient) const {
    if (empty())
        return 0;
    double energy = 0;
    for_touching(x, [&](const Touch& touch, std::size_t) {
        energy += touch.stiffness / 2 * touch.depth * touch.depth;
        Vec3 g = -touch.stiffness * touch.depth * touch.normal;
        if (touch.friction_force > 0 && slip_length_ > 0) {
            const Vec3 u = unpadded(x[touch.corner] - x_n_[touch.corner]);
            const Vec3 slip = u - touch.normal * touch.normal.dot(u);
            const double y = slip.norm();
            energy += touch.friction_force
                      * (y < slip_length_ ? y * y / (2 * slip_length_) : y - slip_length_ / 2);
            g += touch.friction_force / std::max(y, slip_length_) * slip;
        }
        gradient[touch.corner] += padded(g);
    });
    return energy;
}

void ColliderContact::linearize(const Field& x) {
    blocks_.clear();
    if (empty())
        return;
    for_touching(x, [&](const Touch& touch, std::size_t) {
        Mat3 H = Mat3::Zero();
        if (touch.depth > 0)
            H += touch.stiffness * touch.normal * touch.normal.transpose();
        if (touch.friction_force > 0 && slip_length_ > 0) {
            const Mat3 tangential = Mat3::Identity() - touch.normal * touch.normal.transpose();
            const Vec3 slip = tangential * unpadded(x[touch.corner] - x_n_[touch.corner]);
            const double y = slip.norm();
            if (y < slip_length_)
                H += touch.friction_force / slip_length_ * tangential;
            else
                H +=
                    touch.friction_force / y * (tangential - slip * slip.transpose() / (y * y));
        }
        blocks_.push_back({touch.corner, H});
    });
}

void ColliderContact::add_product(const Field& u, Field& product) const {
    for (const Block& block : blocks_)
        product[block.corner] += padded(block.hessian * unpadded(u[block.corner]));
}

void ColliderContact::add_diagonal(Field& diagonal) const {
    for (const Block& block : blocks_)
        diagonal[block.corner] += padded(block.hessian.diagonal());
}

}  // namespace sim
