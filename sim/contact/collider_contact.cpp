#include "sim/contact/collider_contact.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double steepest_distance = 2;  // gap over way, at most
constexpr double impact_depth = 0.01;    // in domain edges
constexpr double share_left = 0.5;       // of a gap, before it is looked at again
constexpr double share_of_thickness =
    0.4;  // that a corner may pass in a step where it is about to touch

Vec3 tangential(const Vec3& u, const Vec3& normal) {
    return u - normal * normal.dot(u);
}

double finest_edge(const std::vector<ContactCorner>& corners) {
    double edge = infinity;
    for (const ContactCorner& corner : corners)
        edge = std::min(edge, corner.edge);
    return edge;
}

/// How far outside a collider a corner touches it at most.   [m]
double longest_reach(const std::vector<ContactCorner>& corners) {
    double reach = 0;
    for (const ContactCorner& corner : corners)
        reach = std::max(reach, -corner.outside);
    return reach;
}

}  // namespace

ColliderContact::ColliderContact(const std::vector<Collider>& colliders,
                                 std::vector<ContactCorner> corners)
    : corners_(std::move(corners)) {
    if (corners_.empty())
        return;
    for (const Collider& collider : colliders)
        colliders_.emplace_back(collider, finest_edge(corners_), longest_reach(corners_));
    for (const ContactCorner& corner : corners_)
        stiffness_.push_back(corner.stiffness);
    grips_.resize(colliders_.size() * corners_.size());
    starts_.resize(grips_.size());
    seen_.resize(grips_.size());
    for (const MovingCollider& collider : colliders_)
        poses_.push_back(collider.pose(0));
    start_poses_ = poses_;
}

double ColliderContact::depth_of(const ContactCorner& corner,
                                 const MovingCollider& collider,
                                 const Pose& pose,
                                 const Vec3& x,
                                 Vec3& normal) const {
    const MovingCollider::Distance distance = collider.distance(pose.bring_back(x));
    normal = pose.R * distance.normal;
    return std::max(0.0, -(distance.gap + corner.outside));
}

ColliderContact::Start ColliderContact::start_of(std::size_t k,
                                                 std::size_t j,
                                                 const Vec3& X) const {
    const MovingCollider::Distance distance = colliders_[j].distance(X);
    const Pose& end = poses_[j];
    return {X, end.R * distance.normal, end.carry(X), distance.gap + corners_[k].outside, true};
}

double ColliderContact::depth_in_step(std::size_t k,
                                      std::size_t j,
                                      const Vec3& x,
                                      Vec3& normal) const {
    // A corner comes no nearer than it moves, seen from the shape; twice as much where the distance is interpolated.
    const auto is_apart = [&](const Start& from) {
        const double way = from.gap / steepest_distance;
        return way > 0 && (x - from.position).squaredNorm() < way * way;
    };
    Start start = starts_[k * colliders_.size() + j];
    if (!start.is_known && !is_apart(start))
        start = start_of(k, j, start.X);
    if (is_apart(start)) {
        normal = start.normal;
        return 0;
    }
    const double depth = depth_of(corners_[k], colliders_[j], poses_[j], x, normal);
    if (normal.dot(start.normal) >= 0)
        return depth;
    normal = start.normal;
    return std::max(0.0, -(start.gap + normal.dot(x - start.position)));
}

template <class Visit>
void ColliderContact::for_touching(const Field& x, const Visit& visit) const {
    for (std::size_t k = 0; k < corners_.size(); ++k) {
        const Vec3 position = unpadded(x[corners_[k].corner]);
        for (std::size_t j = 0; j < colliders_.size(); ++j) {
            Vec3 normal;
            const double depth = depth_in_step(k, j, position, normal);
            const Grip& grip = grips_[k * colliders_.size() + j];
            if (depth > 0 || grip.holds())
                visit(Touch{corners_[k].corner, stiffness_[k], normal, depth, grip});
        }
    }
}

void ColliderContact::begin_step(const Field& x_n,
                                 const std::vector<double>& top_speed,
                                 double time,
                                 double dt) {
    if (empty())
        return;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
        const ContactCorner& corner = corners_[k];
        const double stop = impact_depth * corner.edge;
        const double v = top_speed[corner.body];
        stiffness_[k] = std::max(corner.stiffness, corner.mass * v * v / (stop * stop));
    }
    for (std::size_t j = 0; j < colliders_.size(); ++j) {
        const MovingCollider& collider = colliders_[j];
        const Pose& start = start_poses_[j] = collider.pose(time);
        const Pose& end = poses_[j] = collider.pose(time + dt);
        for (std::size_t k = 0; k < corners_.size(); ++k) {
            const Vec3 X = start.bring_back(unpadded(x_n[corners_[k].corner]));
            Start& at = starts_[k * colliders_.size() + j];
            Seen& seen = seen_[k * colliders_.size() + j];
            Grip& grip = grips_[k * colliders_.size() + j];
            // Far ones are looked at again when they may have come much nearer.
            const double left = seen.gap - steepest_distance * (X - seen.X).norm();
            if (left > share_left * seen.gap) {
                at.X = X;
                at.position = end.carry(X);
                at.gap = left;
                at.is_known = false;
                grip.force = 0;
                continue;
            }
            at = start_of(k, j, X);
            seen = {X, at.gap};
            grip = Grip::of(collider.friction(),
                            stiffness_[k],
                            std::max(0.0, -at.gap),
                            dt,
                            at.normal,
                            at.position);
        }
    }
}

bool ColliderContact::has_changed_touch(const Field& x) const {
    for (std::size_t k = 0; k < corners_.size(); ++k)
        for (std::size_t j = 0; j < colliders_.size(); ++j) {
            Vec3 normal;
            const double depth = depth_in_step(k, j, unpadded(x[corners_[k].corner]), normal);
            if ((depth > 0) != (starts_[k * colliders_.size() + j].gap < 0))
                return true;
        }
    return false;
}

double ColliderContact::largest_step(const Field& x,
                                     const Field& v,
                                     double time,
                                     double dt) const {
    double limit = infinity;
    for (const MovingCollider& collider : colliders_) {
        if (std::isinf(collider.thickness()))
            continue;
        const Pose start = collider.pose(time), end = collider.pose(time + dt);
        for (const ContactCorner& corner : corners_) {
            const Vec3 position = unpadded(x[corner.corner]);
            const Vec3 X = start.bring_back(position);
            const Vec3 relative = unpadded(v[corner.corner]) - (end.carry(X) - position) / dt;
            const double speed = relative.norm();
            const double gap = collider.distance(X).gap + corner.outside;
            if (gap > speed * dt)
                continue;
            limit = std::min(limit,
                             std::max(gap, share_of_thickness * collider.thickness()) / speed);
        }
    }
    return limit;
}

Vec3 ColliderContact::gradient_of(const Touch& touch, const Field& x, double& energy) const {
    energy += touch.stiffness / 2 * touch.depth * touch.depth;
    Vec3 g = -touch.stiffness * touch.depth * touch.normal;
    if (touch.grip.holds())
        energy += touch.grip.add_gradient(unpadded(x[touch.corner]), g);
    return g;
}

Mat3 ColliderContact::hessian_of(const Touch& touch) {
    Mat3 H = Mat3::Zero();
    if (touch.depth > 0)
        H += touch.stiffness * touch.normal * touch.normal.transpose();
    if (touch.grip.holds())
        H += touch.grip.hessian();
    return H;
}

double ColliderContact::add_gradient(const Field& x, Field& gradient) const {
    double energy = 0;
    if (!empty())
        for_touching(x, [&](const Touch& touch) {
            gradient[touch.corner] += padded(gradient_of(touch, x, energy));
        });
    return energy;
}

bool ColliderContact::restrain(const Field& x, double dt, Field& v) const {
    bool any = false;
    for (std::size_t k = 0; k < corners_.size(); ++k)
        for (std::size_t j = 0; j < colliders_.size(); ++j) {
            const ContactCorner& corner = corners_[k];
            Vec3p& velocity = v[corner.corner];
            Vec3 normal;
            const double depth =
                depth_in_step(k, j, unpadded(x[corner.corner] + dt * velocity), normal);
            if (!(depth > 0))
                continue;
            any = true;
            const double stopped = depth / dt;
            const Pose& start = start_poses_[j];
            const Vec3 at = unpadded(x[corner.corner]);
            const Vec3 surface = (poses_[j].carry(start.bring_back(at)) - at) / dt;
            const Vec3 slip = tangential(unpadded(velocity) - surface, normal);
            const Friction& friction = colliders_[j].friction();
            const double most = friction.stick ? infinity : friction.coefficient * stopped;
            const double share = std::min(1.0, most / std::max(slip.norm(), 1e-300));
            velocity += padded(stopped * normal - share * slip);
        }
    return any;
}

void ColliderContact::linearize(const Field& x) {
    blocks_.clear();
    for (std::size_t k = 0; k < corners_.size(); ++k)
        for (std::size_t j = 0; j < colliders_.size(); ++j)
            if (Grip& grip = grips_[k * colliders_.size() + j]; grip.holds())
                grip.linearize(unpadded(x[corners_[k].corner]));
    if (!empty())
        for_touching(x, [&](const Touch& touch) {
            blocks_.push_back({touch.corner, hessian_of(touch)});
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

ColliderContact::Penetration ColliderContact::deepest_penetration(
    const Field& x, double time, const std::vector<char>& held) const {
    Penetration deepest;
    for (std::size_t j = 0; j < colliders_.size(); ++j) {
        const Pose pose = colliders_[j].pose(time);
        for (const ContactCorner& corner : corners_) {
            if (!held.empty() && held[corner.corner])
                continue;
            Vec3 normal;
            const double depth =
                depth_of(corner, colliders_[j], pose, unpadded(x[corner.corner]), normal);
            if (depth / corner.edge > deepest.share)
                deepest = {depth / corner.edge, depth, corner.corner, static_cast<int>(j)};
        }
    }
    return deepest;
}

}  // namespace sim
