// Bodies against each other and themselves, as an energy inside the solve: fine surface against the other's inside.
#pragma once

#include "sim/base/field.h"
#include "sim/contact/contact_energy.h"
#include "sim/contact/contact_surface.h"
#include "sim/contact/point_grid.h"
#include "sim/scene.h"

#include <vector>

namespace sim {

/// A body that takes part; `lattice` outlives the contact.
struct SurfaceBody {
    const Lattice* lattice = nullptr;
    int begin = 0;  // of its corners in the field of all corners
    ContactSurface surface;
};

/// Σ over vertices of one body inside another of  k/2 d² + mu N D(|u_t|).
///
/// The deformed domain of the other body that holds the vertex, its trilinear map inverted, gives the rest point X that
/// the vertex has come to; the other body's distance field there gives phi(X), negative inside. So depth is measured at
/// rest, where it is known, and its gradient n = F^-T grad phi pushes in today's directions. With p the vertex and o the
/// point of the domain that it has met, both sums over eight corners with weights that sum to 1,
///
///   d = max(0, -(phi + n·(p - o))),
///
/// linear in the corners while phi, n and the weights are held: linearised where the step is expected to end, the energy
/// is convex, and the solve is repeated where it has gone far from there (relinearize). Momentum is exact by construction,
/// angular momentum as p = o there. k = stiffness E A / s for a vertex of area A, more where bodies meet faster than waves
/// spread. Friction as in ColliderContact, N and the tangent plane lagged.
///
/// Self-contact leaves out domains within 2.5 domain edges of the vertex at rest.
class SurfaceContact : public ContactEnergy {
  public:
    SurfaceContact(std::vector<SurfaceBody> bodies, const Friction& friction);

    bool empty() const { return bodies_.empty(); }

    /// Finds what may touch in the step from x_n to about x_expected (#C) of length dt [s].
    void begin_step(const Field& x_n,
                    const Field& x_expected,
                    const std::vector<double>& top_speed,
                    double dt);

    /// Linearises anew at x. Returns by how much depths differ from those of the old linearisation, at most, as a share
    /// of the domain's edge.
    double relinearize(const Field& x);

    /// The longest step that moves no vertex further into a body that it may touch than a part of its thickness.   [s]
    double largest_step(const Field& x, const std::vector<double>& top_speed, double dt) const;

    double add_gradient(const Field& x, Field& gradient) const override;
    void linearize(const Field& x) override;
    void add_product(const Field& u, Field& product) const override;
    void add_diagonal(Field& diagonal) const override;

    /// Whether a vertex touches, at the start of the step that has led to x or at its end.
    bool has_touch(const Field& x) const;

    /// What contact takes from velocities v (#C) of corners of masses m (#C) [kg] that would move them from x in an
    /// explicit step: the part that would end inside, as impulses between vertex and domain.
    void restrain(const Field& x, const Field& m, double dt, Field& v) const;

    /// Deepest penetration and smallest gap at x, as shares of the domain's edge; gaps are known up to `reach`.
    struct Report {
        double penetration = 0, gap = reach;
    };

    static constexpr double reach = 1;  // in domain edges
    Report report(const Field& x) const;

  private:
    struct Contact {
        const ContactVertex* vertex = nullptr;
        int pair = 0;
        std::array<int, 8> corners{};  // of the domain
        std::array<double, 8> weights{};
        double phi = 0, edge = 0;  // [m]
        Vec3 normal{0, 0, 0};      // n
        double stiffness = 0;      // k [N/m]
        // Friction, fixed at the start of the step.
        Vec3 start{0, 0, 0};  // p - o then [m]
        double grip_force = 0, slip_length = 0, grip_stiffness = 0;
        bool touched = false;
        Mat3 hessian = Mat3::Zero();  // on p - o
    };

    struct Pair {
        int of_vertices = 0, of_domains = 0;  // bodies
        double reach = 0;  // that they may still move before anything can touch [m]
    };

    struct Place;  // where a vertex is in a body

    bool may_touch(const Pair& pair, const Field& x, double margin, double& reach_left) const;
    bool is_folded(int body, const Field& x) const;
    void find_contacts(int pair,
                       const Field& x,
                       double margin,
                       std::vector<Contact>& found) const;
    Place locate(const SurfaceBody& body,
                 const PointGrid& grid,
                 const std::vector<int>& domains,
                 const Field& x,
                 const Vec3& point,
                 const Vec3* rest_of_self) const;
    bool linearize_depth(const SurfaceBody& body,
                         const Place& place,
                         const Field& x,
                         Contact& contact) const;
    void prepare(Contact& contact) const;
    static Vec3 separation(const Contact& contact, const Field& x);
    static void scatter(const Contact& contact, const Vec3& f, Field& field);

    static double depth_of(const Contact& contact, const Vec3& separation) {
        return std::max(0.0, -(contact.phi + contact.normal.dot(separation)));
    }

    std::vector<SurfaceBody> bodies_;
    Friction friction_;
    std::vector<Pair> pairs_;
    std::vector<std::vector<int>> shell_;   // (#bodies) domains near the surface
    std::vector<int> active_;               // pairs that may touch in this step
    std::vector<double> margins_, speeds_;  // (#pairs) of this step [m], [m/s]
    std::vector<Contact> contacts_;
    Field x_n_;
    double dt_ = 0;
};

}  // namespace sim
