// Corners against still colliders, as an energy inside the solve.
#pragma once

#include "sim/base/field.h"
#include "sim/scene.h"

#include <vector>

namespace sim {

/// A corner that may touch: those on the surface of a body.
struct ContactCorner {
    int corner = 0;      // in the field of all corners
    double outside = 0;  // distance that it sticks out of the body's surface at rest, >= 0 [m]
    double stiffness = 0;  // k of the penalty [N/m]
};

/// Σ over corners and colliders of
///
///   k/2 d² + mu N D(|u_t|),   d = max(0, -(gap + outside)),   D(y) = y²/(2 e) for y < e, else y - e/2
///
/// d [m] is the penetration of the body's surface, u_t the displacement in the step along the tangent plane of its
/// start, N = k d the normal force there (both lagged, which makes friction a convex potential), e = slip_speed dt the
/// displacement below which friction holds elastically instead of sliding. Friction "stick" holds what touched at the
/// start of the step like a spring, k/2 |u_t|², which no force makes slide. k = contact_stiffness E s leaves a depth
/// p s / (k / s) under a pressure p, i.e. less than a thousandth of a domain for bodies that carry their own weight.
class ColliderContact {
  public:
    ColliderContact(std::vector<Collider> colliders, std::vector<ContactCorner> corners);

    bool empty() const { return colliders_.empty() || corners_.empty(); }

    /// Fixes the state at the start of a step: x_n (#C), the normal forces of friction, and dt [s].
    void begin_step(const Field& x_n, double dt);

    /// Adds ∂/∂x to `gradient` (#C) [N] and returns the energy [J]. Friction is left out where dt is 0 (statics).
    double add_gradient(const Field& x, Field& gradient) const;

    /// Keeps the 3×3 Hessians of the corners that touch at x.
    void linearize(const Field& x);

    /// Adds to `impulse` (#C) what touching gives corners of masses m (#C) [kg] in an explicit step that has led to x:
    /// -dt (1 + dt²/m H)⁻¹ g, each corner for itself, which never makes it bounce however stiff it is.   [N s]
    void add_impulses(const Field& x, const Field& m, double dt, Field& impulse) const;

    /// product += H u.
    void add_product(const Field& u, Field& product) const;

    /// diagonal += diag H.
    void add_diagonal(Field& diagonal) const;

  private:
    /// Friction of a corner on a collider, fixed at the start of a step.
    struct Grip {
        Vec3 normal{0, 0, 1};
        double force = 0;  // that slipping meets, infinite: sticks, 0: nothing touched [N]
        double slip_length = 0;  // e [m]
        double stiffness = 0;    // below e [N/m]
    };

    struct Touch {
        int corner = 0;
        double stiffness = 0;  // k of the penalty [N/m]
        Vec3 normal{0, 0, 1};
        double depth = 0;  // d [m]
        const Grip& grip;
    };

    Vec3 gradient_of(const Touch& touch, const Field& x, double& energy) const;
    Mat3 hessian_of(const Touch& touch, const Field& x) const;
    template <class Visit>
    void for_touching(const Field& x, const Visit& visit) const;

    std::vector<Collider> colliders_;
    std::vector<ContactCorner> corners_;
    std::vector<Grip> grips_;  // (#corners × #colliders)
    Field x_n_;

    struct Block {
        int corner = 0;
        Mat3 hessian;
    };

    std::vector<Block> blocks_;
};

}  // namespace sim
