#include "sim/contact/collider_contact.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int far = -1;                // in place of the number of a pair
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
    x_n_.resize(corners_.size());
    starts_.resize(corners_.size() * colliders.size());
    grips_.resize(starts_.size());
    for (const Collider& collider : colliders)
        colliders_.emplace_back(collider, finest_edge_, longest_reach(corners_));
    std::vector<int> indices;
    for (const ContactCorner& corner : corners_)
        indices.push_back(corner.corner);
    near_ = {std::move(indices), colliders_.size(), margin * finest_edge_};
    for (const MovingCollider& collider : colliders_)
        poses_.push_back(collider.pose(0));
    start_poses_ = poses_;
}

bool ColliderContact::has_thin() const {
    return std::any_of(
        colliders_.begin(), colliders_.end(), [](const MovingCollider& collider) {
            return std::isfinite(collider.thickness());
        });
}

double ColliderContact::gap(int k, int j, const Vec3& X) const {
    return colliders_[j].distance(X).gap + corners_[k].outside;
}

double ColliderContact::stiffness_of(int k, const Start& start) const {
    const ContactCorner& corner = corners_[k];
    const double stop = impact_depth * corner.edge;
    double v = top_speed_.empty() ? 0 : top_speed_[corner.body];
    if (dt_ > 0)
        v += (start.position - unpadded(x_n_[k])).norm() / dt_;
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

ColliderContact::Start ColliderContact::start_of(int k, int j, const Vec3p& x) const {
    const Vec3 X = start_poses_[j].bring_back(unpadded(x));
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

template <class From, class To, class Visit>
void ColliderContact::for_pairs(double way,
                                const From& start,
                                const To& end,
                                const Visit& visit) const {
    const int n_colliders = static_cast<int>(colliders_.size());
    const std::vector<int>& near = near_.near();
    int next = 0;
    for (const int k : near_.touching(way)) {
        const bool is_near = next < static_cast<int>(near.size()) && near[next] == k;
        for (int j = 0; j < n_colliders; ++j) {
            const int pair = is_near ? next * n_colliders + j : far;
            const Start begun = is_near ? starts_[pair] : start_of(k, j, start(k));
            Vec3 normal;
            const double depth =
                depth_in_step(k, j, begun, unpadded(end(corners_[k].corner)), normal);
            visit(k, j, begun, depth, normal, pair);
        }
        next += is_near;
    }
}

template <class Visit>
void ColliderContact::for_pairs(const Field& x, const Visit& visit) const {
    if (empty())
        return;
    for_pairs(
        near_.farthest([&](int k) { return x[corners_[k].corner] - x_n_[k]; }),
        [&](int k) { return x_n_[k]; },
        [&](int c) { return x[c]; },
        visit);
}

template <class Visit>
void ColliderContact::for_touching(const Field& x, const Visit& visit) const {
    static const Grip none;  // as a far corner does not touch at the start
    for_pairs(
        x, [&](int k, int, const Start& start, double depth, const Vec3& normal, int pair) {
            const Grip& grip = pair == far ? none : grips_[pair];
            if (depth > 0 || grip.holds())
                visit(Touch{corners_[k].corner, stiffness_of(k, start), normal, depth, grip});
        });
}

void ColliderContact::begin(const Field& x_n, double gone, double time, double dt) {
    dt_ = dt;
    const int n_colliders = static_cast<int>(colliders_.size());
    for (int j = 0; j < n_colliders; ++j) {
        start_poses_[j] = colliders_[j].pose(time);
        poses_[j] = colliders_[j].pose(time + dt);
    }
    near_.begin_step(x_n, gone, start_poses_, poses_, [&](int k, int j, const Vec3& X) {
        return gap(k, j, X);
    });
    starts_.clear();
    for (const int k : near_.near())
        for (int j = 0; j < n_colliders; ++j)
            starts_.push_back(start_of(k, j, x_n[corners_[k].corner]));
}

void ColliderContact::begin_step(const Field& x_n,
                                 const std::vector<double>& top_speed,
                                 double time,
                                 double dt) {
    if (empty())
        return;
    begin(x_n, infinity, time, dt);
    top_speed_ = top_speed;
    x_n_.clear();
    for (const ContactCorner& corner : corners_)
        x_n_.push_back(x_n[corner.corner]);
    grips_.clear();
    for (std::size_t pair = 0; pair < starts_.size(); ++pair) {
        const Start& start = starts_[pair];
        grips_.push_back(Grip::of(colliders_[pair % colliders_.size()].friction(),
                                  stiffness_of(near_.near()[pair / colliders_.size()], start),
                                  std::max(0.0, -start.gap),
                                  dt,
                                  start.normal,
                                  start.position));
    }
}

void ColliderContact::begin_drift(const Field& x_n, double gone, double time, double dt) {
    if (!empty())
        begin(x_n, gone, time, dt);
}

bool ColliderContact::has_changed_touch(const Field& x) const {
    bool has_changed = false;
    for_pairs(x, [&](int, int, const Start& start, double depth, const Vec3&, int) {
        has_changed = has_changed || (depth > 0) != (start.gap < 0);
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

std::vector<int> ColliderContact::touching(double way) const {
    std::vector<int> corners;
    if (!empty())
        for (const int k : near_.touching(way))
            corners.push_back(corners_[k].corner);
    return corners;
}

std::vector<ColliderContact::Stop> ColliderContact::stops(const Field& x_n,
                                                          const Field& v,
                                                          double way,
                                                          double least_depth) const {
    std::vector<Stop> stops;
    if (empty())
        return stops;
    const auto start = [&](int k) { return x_n[corners_[k].corner]; };
    const auto end = [&](int c) { return x_n[c] + dt_ * v[c]; };
    for_pairs(way,
              start,
              end,
              [&](int k, int j, const Start& begun, double depth, const Vec3& normal, int) {
                  const auto& [c, body, outside, stiffness, mass, edge] = corners_[k];
                  if (!(depth > least_depth * edge))
                      return;
                  const Vec3 carried = (begun.position - unpadded(x_n[c])) / dt_;
                  const double along = normal.dot(dt_ * (unpadded(v[c]) - carried));
                  stops.push_back(
                      {c,
                       depth / edge,
                       {normal, -depth - along, edge, colliders_[j].friction(), carried}});
              });
    return stops;
}

void ColliderContact::linearize(const Field& x) {
    blocks_.clear();
    for (std::size_t i = 0; i < grips_.size(); ++i)
        if (Grip& grip = grips_[i]; grip.holds()) {
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
