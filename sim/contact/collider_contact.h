// Corners against colliders, as an energy inside the solve.
#pragma once

#include "sim/base/field.h"
#include "sim/contact/contact_energy.h"
#include "sim/contact/grip.h"
#include "sim/contact/impulses.h"
#include "sim/contact/moving_collider.h"
#include "sim/contact/near_corners.h"

#include <vector>

namespace sim {

/// A corner that may touch: those on the surface of a body.
struct ContactCorner {
    int corner = 0;  // in the field of all corners
    int body = 0;
    // Distance that it sticks out of the body's surface at rest; < 0: lies inside [m]
    double outside = 0;
    double stiffness = 0;  // k of the penalty [N/m]
    double mass = 0;       // [kg]
    double edge = 0;       // of its body's domains, s [m]
};

/// Σ over corners and colliders of  k/2 d² + friction (Grip),   d = max(0, -(gap + outside)).
///
/// d [m] is the penetration of the body's surface where the collider is at the end of the step; friction resists the
/// displacement in the step relative to the collider. k = contact_stiffness E s leaves a depth p s / (k / s) under a
/// pressure p, i.e. less than a thousandth of a domain for bodies that carry their own weight; where it is more, k is
/// m v² / d_impact² with the body's top speed lately and the collider's where the corner is, together v: d_impact = s/100
/// stops one that comes so fast.
///
/// Beyond the middle of a thin collider the way out is that to the side where the corner was at the start of the step:
/// whatever a solver tries in between, no minimum of the energy lies behind the collider.
class ColliderContact : public ContactEnergy {
  public:
    ColliderContact(const std::vector<Collider>& colliders, std::vector<ContactCorner> corners);

    bool empty() const { return colliders_.empty() || corners_.empty(); }

    /// Whether corners might pass through any.
    bool has_thin() const;

    /// Of the bodies' domains.   [m]
    double finest_edge() const { return finest_edge_; }

    /// Fixes what the step from `time` to time + dt starts with: x_n (#C), the bodies' top speeds (#bodies) [m/s], and
    /// the normal forces of friction.
    void begin_step(const Field& x_n,
                    const std::vector<double>& top_speed,
                    double time,
                    double dt);

    /// The same for one drift of an explicit step: what stops() asks for. `gone`: how far any corner has gone since the step
    /// or drift before began, at most; infinite where nothing is known of it.   [m]
    void begin_drift(const Field& x_n, double gone, double time, double dt);

    /// The longest step at x, v (#C) that lets no corner pass through a thin collider: up to where it touches, or, near
    /// that, a part of the thickness; infinite where none comes near within `dt`.   [s]
    double largest_step(const Field& x, const Field& v, double time, double dt) const;

    /// Whether a corner has begun or ceased to touch since the start of the step that has led to x.
    bool has_changed_touch(const Field& x) const;

    /// Friction is left out where dt is 0 (statics).
    double add_gradient(const Field& x, Field& gradient) const override;

    /// Curvature of the collider is left out of the Hessian.
    void linearize(const Field& x) override;
    void add_product(const Field& u, Field& product) const override;
    void add_diagonal(Field& diagonal) const override;

    /// A corner that an explicit step would move into a collider.
    struct Stop {
        int corner = 0;    // in the field of all corners
        double depth = 0;  // where the step would end [domain edges]
        Impulses::Touch touch;
    };

    /// Those that may touch in the drift that has begun if none goes further than `way`, in the field of all corners.   [m]
    std::vector<int> touching(double way) const;

    /// Those of them that velocities v (#C) would move from x_n by more than `least_depth` [domain edges] into a collider, each
    /// with the collider as a plane where the corner would end. v counts where touching(way) says.
    std::vector<Stop> stops(const Field& x_n,
                            const Field& v,
                            double way,
                            double least_depth) const;

    /// Of a corner in a collider.
    struct Penetration {
        double share = 0;  // depth over the domain's edge; 0 where nothing penetrates
        double depth = 0;  // [m]
        int corner = -1, collider = -1;  // in the field of all corners, in the scene
    };

    /// The deepest one at x and `time`, in domain edges, of corners but those `held` (#C, or none).
    Penetration deepest_penetration(const Field& x,
                                    double time,
                                    const std::vector<char>& held = {}) const;

  private:
    /// A corner and a collider at the start of the step, as the collider carries them to its end.
    struct Start {
        Vec3 normal{0, 0, 0}, position{0, 0, 0};  // the normal is 0 before the first step
        double gap = 0;                           // of the body's surface [m]
    };

    struct Touch {
        int corner = 0;
        double stiffness = 0;  // k of the penalty [N/m]
        Vec3 normal{0, 0, 1};
        double depth = 0;  // d [m]
        const Grip& grip;
    };

    double gap(int k, int j, const Vec3& X) const;
    double stiffness_of(int k, const Start& start) const;
    Start start_of(int k, int j, const Vec3p& x) const;
    void begin(const Field& x_n, double gone, double time, double dt);
    Vec3 gradient_of(const Touch& touch, const Field& x, double& energy) const;
    static Mat3 hessian_of(const Touch& touch);
    double depth_of(const ContactCorner& corner,
                    const MovingCollider& collider,
                    const Pose& pose,
                    const Vec3& x,
                    Vec3& normal) const;
    double depth_in_step(int k, int j, const Start& start, const Vec3& x, Vec3& normal) const;

    // All that may touch where the step ends with corners of the field at `end(corner)`, no further from start(k), where it
    // began with them, than `way`; corner by corner and by collider: visit(k, j, start, depth, normal, number of the pair).
    template <class From, class To, class Visit>
    void for_pairs(double way, const From& start, const To& end, const Visit& visit) const;
    // The same where corners end at x.
    template <class Visit>
    void for_pairs(const Field& x, const Visit& visit) const;
    template <class Visit>
    void for_touching(const Field& x, const Visit& visit) const;

    std::vector<MovingCollider> colliders_;
    std::vector<ContactCorner> corners_;
    double finest_edge_ = 0;
    NearCorners near_;
    Field x_n_;                      // (#corners) at the start of a step that is no drift [m]
    std::vector<Start> starts_;      // of pairs (#near × #colliders)
    std::vector<Grip> grips_;        // the same; of those that are not near none holds
    std::vector<double> top_speed_;  // (#bodies) of this step; none before the first [m/s]
    double dt_ = 0;                  // of this step [s]
    // (#colliders) at the start and the end of the step.
    std::vector<Pose> start_poses_, poses_;

    struct Block {
        int corner = 0;
        Mat3 hessian;
    };

    std::vector<Block> blocks_;
};

}  // namespace sim
