// Coulomb friction of one point for one step, as a convex potential.
#pragma once

#include "assets/base/vector_types.h"
#include "sim/scene.h"

#include <limits>

namespace sim {

/// mu N D(|u_t|),   D(y) = y²/(2 e) for y < e, else y - e/2,   u_t the part of u - origin in the tangent plane.
///
/// N and the plane are those of the step's start, which makes it convex. Below e friction holds like a spring instead
/// of sliding. `Friction::stick` holds like a spring that no force makes slide.
struct Grip {
    Vec3 normal{0, 0, 1};  // unit
    Vec3 origin{0, 0, 0};  // where the point was at the start of the step [m]
    double force = 0;  // mu N, that slipping meets; infinite: sticks, 0: nothing touched [N]
    double slip_length = 0;  // e [m]
    double stiffness = 0;    // below e [N/m]

    /// Of a point pressed by N = k d = `stiffness` `depth` at the start of a step of `dt`; none where that is 0.
    static Grip of(const Friction& friction,
                   double stiffness,
                   double depth,
                   double dt,
                   const Vec3& normal,
                   const Vec3& origin);

    bool holds() const { return force > 0; }

    /// Adds the gradient at u to g [N] and returns the energy [J].
    double add_gradient(const Vec3& u, Vec3& g) const;

    /// Keeps a positive semi-definite Hessian at u for Newton's method: primal and dual, as [CGM99] minimise total variation.
    ///
    /// The energy's own Hessian has nothing along the slip where it slides, and mu N / e where it holds: from the one side
    /// of u = origin Newton's step goes far beyond on the other, and the line search is left to find the way. Here
    /// friction's direction w, |w| <= 1, is an unknown by itself with  max(e, |u_t|) w = u_t  linearised too, and
    ///
    ///   H = mu N / |u_t| (P - (w u_tᵀ + u_t wᵀ) / (2 |u_t|))
    ///
    /// is the energy's own once w is u_t / |u_t|. At first, w = 0, it bounds the energy from above.
    void linearize(const Vec3& u);

    const Mat3& hessian() const { return hessian_; }  // [N/m]

  private:
    Mat3 hessian_ = Mat3::Zero();
    Vec3 slip_{0, 0, 0},
        direction_{0, 0, 0};  // u_t and w of the last linearisation; before the first 0
};

}  // namespace sim
