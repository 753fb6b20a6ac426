// A collider's shape and its motion.
#pragma once

#include "assets/generators/distance_field.h"
#include "sim/scene.h"

#include <memory>

namespace sim {

/// x = pivot + R (X - pivot) + translate: where a point X of the shape, as the shot file places it, is at a time.
struct Pose {
    Mat3 R = Mat3::Identity();
    Vec3 pivot{0, 0, 0}, translate{0, 0, 0};

    Vec3 carry(const Vec3& X) const { return pivot + R * (X - pivot) + translate; }

    Vec3 bring_back(const Vec3& x) const {
        return pivot + R.transpose() * (x - pivot - translate);
    }
};

/// The gap from a collider changes by no more than this times the way that a point goes: 1 but where it is interpolated.
constexpr double steepest_distance = 2;

class MovingCollider {
  public:
    /// `resolution`: the scale at which details matter of what has no formula (a mesh, ellipsoids and combined shapes):
    /// the smallest domain's edge [m]. Up to a distance of `reach` [m] it is as exact outside as inside. Throws
    /// Error(Input) where a mesh is not closed, and as collider_field() does.
    MovingCollider(const Collider& collider, double resolution, double reach = 0);

    /// Between keys translation and the angles, about the pivot, are linear, so that a shape may turn by more than
    /// half a turn from one to the next; before the first key and after the last it stands still.
    Pose pose(double time) const;

    struct Distance {
        double gap = 0;        // signed, negative inside [m]
        Vec3 normal{0, 0, 1};  // outward of the shape
    };

    /// From a point X in the shape's own frame. Beyond `reach` the gap may be less than the distance, but no less than
    /// `reach`.
    Distance distance(const Vec3& X) const;

    /// The smallest extent along the axes, or less where walls are thinner: what a fast corner might pass through; infinite
    /// for a plane.   [m]
    double thickness() const { return thickness_; }

    const Friction& friction() const { return friction_; }

  private:
    std::variant<PlaneShape,
                 assets::Box,
                 assets::Sphere,
                 assets::Cylinder,
                 assets::Capsule,
                 assets::Torus,
                 std::shared_ptr<const assets::DistanceField>>
        shape_;
    std::vector<ColliderKey> keys_;
    Friction friction_;
    Vec3 pivot_{0, 0, 0};
    double thickness_ = 0;
};

/// The source of a collider that is no plane.
assets::Source collider_source(const Collider& collider);

}  // namespace sim
