#include "sim/contact/collider_contact.h"

#include "assets/generators/shape.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double slip_speed = 1e-3;  // [m/s]

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
    Distance inside{-infinity, {}};
    for (int k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            const double gap = side > 0 ? x[k] - box.max[k] : box.min[k] - x[k];
            if (gap > inside.gap)
                inside = {gap, side * Vec3::Unit(k)};
        }
    return inside;
}

Vec3 tangential(const Vec3& u, const Vec3& normal) {
    return u - normal * normal.dot(u);
}

}  // namespace

ColliderContact::ColliderContact(std::vector<Collider> colliders,
                                 std::vector<ContactCorner> corners)
    : colliders_(std::move(colliders)), corners_(std::move(corners)) {
    grips_.resize(colliders_.size() * corners_.size());
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
            const Grip& grip = grips_[pair];
            if (depth > 0 || grip.force > 0)
                visit(Touch{corner.corner, corner.stiffness, distance.normal, depth, grip},
                      pair);
        }
    }
}

void ColliderContact::begin_step(const Field& x_n, double dt) {
    if (empty())
        return;
    x_n_ = x_n;
    std::vector<Grip> grips(grips_.size());
    const double slip_length = slip_speed * dt;
    if (slip_length > 0)
        for_touching(x_n, [&](const Touch& touch, std::size_t pair) {
            const Friction& friction = colliders_[pair % colliders_.size()].friction;
            const double force = friction.coefficient * touch.stiffness * touch.depth;
            if (touch.depth > 0 && friction.stick)
                grips[pair] = {touch.normal, infinity, infinity, touch.stiffness};
            else if (force > 0)
                grips[pair] = {touch.normal, force, slip_length, force / slip_length};
        });
    grips_ = std::move(grips);
}

Vec3 ColliderContact::gradient_of(const Touch& touch, const Field& x, double& energy) const {
    const Grip& grip = touch.grip;
    energy += touch.stiffness / 2 * touch.depth * touch.depth;
    Vec3 g = -touch.stiffness * touch.depth * touch.normal;
    if (grip.force > 0) {
        const Vec3 slip =
            tangential(unpadded(x[touch.corner] - x_n_[touch.corner]), grip.normal);
        const double y = slip.norm();
        const bool holds = y < grip.slip_length;
        energy += holds ? grip.stiffness / 2 * y * y : grip.force * (y - grip.slip_length / 2);
        g += (holds ? grip.stiffness : grip.force / y) * slip;
    }
    return g;
}

Mat3 ColliderContact::hessian_of(const Touch& touch, const Field& x) const {
    const Grip& grip = touch.grip;
    Mat3 H = Mat3::Zero();
    if (touch.depth > 0)
        H += touch.stiffness * touch.normal * touch.normal.transpose();
    if (grip.force > 0) {
        const Mat3 P = Mat3::Identity() - grip.normal * grip.normal.transpose();
        const Vec3 slip = P * unpadded(x[touch.corner] - x_n_[touch.corner]);
        const double y = slip.norm();
        if (y < grip.slip_length)
            H += grip.stiffness * P;
        else
            H += grip.force / y * (P - slip * slip.transpose() / (y * y));
    }
    return H;
}

double ColliderContact::add_gradient(const Field& x, Field& gradient) const {
    double energy = 0;
    if (!empty())
        for_touching(x, [&](const Touch& touch, std::size_t) {
            gradient[touch.corner] += padded(gradient_of(touch, x, energy));
        });
    return energy;
}

void ColliderContact::add_impulses(const Field& x,
                                   const Field& m,
                                   double dt,
                                   Field& impulse) const {
    if (empty())
        return;
    for_touching(x, [&](const Touch& touch, std::size_t) {
        double energy = 0;
        const Vec3 g = gradient_of(touch, x, energy);
        const Mat3 A = Mat3::Identity() + dt * dt / m[touch.corner][0] * hessian_of(touch, x);
        impulse[touch.corner] -= padded(dt * A.ldlt().solve(g));
    });
}

void ColliderContact::linearize(const Field& x) {
    blocks_.clear();
    if (!empty())
        for_touching(x, [&](const Touch& touch, std::size_t) {
            blocks_.push_back({touch.corner, hessian_of(touch, x)});
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
