#include "sim/contact/collider_contact.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double impact_depth = 0.01;  // in domain edges
constexpr double margin = 0.5;         // of the domain's edge, where corners count as near
// That a corner may pass in a step where it is about to touch.
constexpr double share_of_thickness = 0.4;

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
    finest_edge_ = infinity;
    for (const ContactCorner& corner : corners_)
        finest_edge_ = std::min(finest_edge_, corner.edge);
    for (const Collider& collider : colliders)
        colliders_.emplace_back(collider, finest_edge_, longest_reach(corners_));
    std::vector<int> indices;
    for (const ContactCorner& corner : corners_)
        indices.push_back(corner.corner);
    near_ = {std::move(indices), colliders_.size(), margin * finest_edge_};
    pairs_.resize(corners_.size() * colliders_.size());
    for (const MovingCollider& collider : colliders_)
        poses_.push_back(collider.pose(0));
    start_poses_ = poses_;
}

double ColliderContact::gap(int k, int j, const Vec3& X) const {
    return colliders_[j].distance(X).gap + corners_[k].outside;
}

double ColliderContact::stiffness_of(int k, const Start& start) const {
    const ContactCorner& corner = corners_[k];
    const double stop = impact_depth * corner.edge;
    double v = top_speed_.empty() ? 0 : top_speed_[corner.body];
    if (dt_ > 0)
        v += (start.position - near_.start(k)).norm() / dt_;
    return std::max(corner.stiffness, corner.mass * v * v / (stop * stop));
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

ColliderContact::Start ColliderContact::start_of(int k, int j) const {
    const Vec3 X = start_poses_[j].bring_back(near_.start(k));
    const MovingCollider::Distance distance = colliders_[j].distance(X);
    const Pose& end = poses_[j];
    // Unit also where a gradient of means over both sides of a wall is short.
    return {
        end.R * distance.normal.normalized(), end.carry(X), distance.gap + corners_[k].outside};
}

double ColliderContact::depth_in_step(
    int k, int j, const Start& start, const Vec3& x, Vec3& normal) const {
    // A corner comes no nearer than it moves, seen from the shape; twice as much where the distance is interpolated.
    const double way = start.gap / steepest_distance;
    if (way > 0 && (x - start.position).squaredNorm() < way * way) {
        normal = start.normal;
        return 0;
    }
    const double depth = depth_of(corners_[k], colliders_[j], poses_[j], x, normal);
    // Around the middle a gradient of means over both sides is short, and would let a corner slip to the other one.
    if (normal.dot(start.normal) >= 0 && normal.squaredNorm() > 0.5)
        return depth;
    normal = start.normal;
    return std::max(0.0, -(start.gap + normal.dot(x - start.position)));
}

template <class Position, class Way, class Visit>
void ColliderContact::for_pairs(const Position& at, const Way& way, const Visit& visit) const {
    if (empty())
        return;
    const int n_colliders = static_cast<int>(colliders_.size());
    const std::vector<int>& near = near_.near();
    std::size_t next = 0;
    Pair far;  // which grips nothing, as it does not touch at the start
    for (const int k : near_.touching(way)) {
        const bool is_near = next < near.size() && near[next] == k;
        for (int j = 0; j < n_colliders; ++j) {
            if (!is_near)
                far.start = start_of(k, j);
            const Pair& pair = is_near ? pairs_[next * n_colliders + j] : far;
            Vec3 normal;
            const double depth =
                depth_in_step(k, j, pair.start, unpadded(at(corners_[k].corner)), normal);
            visit(k, j, pair, depth, normal);
        }
        next += is_near;
    }
}

template <class Visit>
void ColliderContact::for_touching(const Field& x, const Visit& visit) const {
    for_pairs(
        [&](int c) { return x[c]; },
        [&](int c, const Vec3p& start) { return x[c] - start; },
        [&](int k, int, const Pair& pair, double depth, const Vec3& normal) {
            const ContactCorner& corner = corners_[k];
            if (depth > 0 || pair.grip.holds())
                visit(Touch{
                    corner.corner, stiffness_of(k, pair.start), normal, depth, pair.grip});
        });
}

void ColliderContact::begin_step(const Field& x_n,
                                 const std::vector<double>& top_speed,
                                 double time,
                                 double dt) {
    if (empty())
        return;
    top_speed_ = top_speed;
    dt_ = dt;
    const int n_colliders = static_cast<int>(colliders_.size());
    for (int j = 0; j < n_colliders; ++j) {
        start_poses_[j] = colliders_[j].pose(time);
        poses_[j] = colliders_[j].pose(time + dt);
    }
    near_.begin_step(
        x_n, start_poses_, poses_, [&](int k, int j, const Vec3& X) { return gap(k, j, X); });
    pairs_.clear();
    for (const int k : near_.near())
        for (int j = 0; j < n_colliders; ++j) {
            const Start start = start_of(k, j);
            const double depth = std::max(0.0, -start.gap);
            pairs_.push_back({start,
                              Grip::of(colliders_[j].friction(),
                                       stiffness_of(k, start),
                                       depth,
                                       dt,
                                       start.normal,
                                       start.position)});
        }
}

bool ColliderContact::has_changed_touch(const Field& x) const {
    bool has_changed = false;
    for_pairs([&](int c) { return x[c]; },
              [&](int c, const Vec3p& start) { return x[c] - start; },
              [&](int, int, const Pair& pair, double depth, const Vec3&) {
                  has_changed = has_changed || (depth > 0) != (pair.start.gap < 0);
              });
    return has_changed;
}

double ColliderContact::largest_step(const Field& x,
                                     const Field& v,
                                     double time,
                                     double dt) const {
    double limit = infinity;
    for (int j = 0; j < static_cast<int>(colliders_.size()); ++j) {
        const MovingCollider& collider = colliders_[j];
        if (std::isinf(collider.thickness()))
            continue;
        const Pose start = collider.pose(time), end = collider.pose(time + dt);
        for (const int k : near_.reaching(j, x, v, dt, start, end)) {
            const int c = corners_[k].corner;
            const Vec3 position = unpadded(x[c]);
            const Vec3 X = start.bring_back(position);
            const Vec3 relative = unpadded(v[c]) - (end.carry(X) - position) / dt;
            const double speed = relative.norm(), left = gap(k, j, X);
            if (left > speed * dt)
                continue;
            limit = std::min(limit,
                             std::max(left, share_of_thickness * collider.thickness()) / speed);
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
    for_touching(x, [&](const Touch& touch) {
        gradient[touch.corner] += padded(gradient_of(touch, x, energy));
    });
    return energy;
}

std::vector<ColliderContact::Stop> ColliderContact::stops(const Field& x,
                                                          const Field& v,
                                                          double dt,
                                                          double least_depth) const {
    std::vector<Stop> stops;
    const auto end = [&](int c) { return x[c] + dt * v[c]; };
    const auto way = [&](int c, const Vec3p&) { return dt * v[c]; };
    for_pairs(end, way, [&](int k, int j, const Pair&, double depth, const Vec3& normal) {
        const auto& [c, body, outside, stiffness, mass, edge] = corners_[k];
        if (!(depth > least_depth * edge))
            return;
        const Vec3 at = unpadded(x[c]),
                   carried = (poses_[j].carry(start_poses_[j].bring_back(at)) - at) / dt;
        const double along = normal.dot(dt * (unpadded(v[c]) - carried));
        stops.push_back({c,
                         depth / edge,
                         {normal, -depth - along, edge, colliders_[j].friction(), carried}});
    });
    return stops;
}

void ColliderContact::linearize(const Field& x) {
    blocks_.clear();
    for (std::size_t i = 0; i < pairs_.size(); ++i)
        if (Grip& grip = pairs_[i].grip; grip.holds()) {
            const int k = near_.near()[i / colliders_.size()];
            grip.linearize(unpadded(x[corners_[k].corner]));
        }
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
