// Contact on the grid as an energy inside the solve of implicit steps.
#pragma once

#include "sim/contact/contact_energy.h"
#include "sim/contact/impulses.h"

#include <utility>
#include <vector>

namespace sim {

/// Of each node where bodies have met, with u = Σ weight (x - x_n) the way of p - o in the step, u_n along the normal and u_t
/// across it, by augmented Lagrangians ([SL92] for friction):
///
///   1/(2k) (max(0, push - k u_n)² - push²)  +  (D(hold - k u_t) - |hold|²/2) / k,
///   D(y) = |y|²/2 where |y| <= mu push, else mu push (|y| - mu push / 2)
///
/// The multipliers push [N], along the normal, and hold [N], across it, are those of the last solve (update). Impulses after
/// the solve know of masses alone: where a step is long against a body's waves, its stress would be that of a body gone
/// through the other, and give back energy that nobody had put in. Here stress knows of contact. k = firmness m / dt², with
/// m the mass that the contact pushes.
class GridHold : public ContactEnergy {
  public:
    /// Forgets all: those that follow are of a step of dt [s] from x_n (#C) [m], which is referred to.
    void begin_step(const Field& x_n, double dt);

    bool empty() const { return contacts_.empty(); }

    /// Where two bodies meet: the pair, and the node.
    using Place = std::pair<int, int>;

    bool has(const Place& place) const;

    /// At a place. `mass` [kg] is what it pushes, `push` and `hold` are the multipliers [N].
    struct Contact {
        Place place;
        Vec3 normal{0, 0, 1};  // unit, out of o
        double edge = 0;       // of a domain [m]
        Friction friction;
        std::vector<Impulses::Share> shares;  // of corners in p - o
        double mass = 0, push = 0;
        Vec3 hold{0, 0, 0};
    };

    /// Multipliers become the forces at x, the end of a solve, and contacts that it has not known begin with theirs. Returns
    /// whether none changes by more than a share of the largest, or by what hardly moves anything.
    bool update(const Field& x, std::vector<Contact> met);

    double add_gradient(const Field& x, Field& gradient) const override;
    void linearize(const Field& x) override;
    void add_product(const Field& u, Field& product) const override;
    void add_diagonal(Field& diagonal) const override;

  private:
    /// On p - o.
    struct Force {
        double push = 0;
        Vec3 tried{0, 0, 0},
            hold{0, 0, 0};  // across the normal, before and after Coulomb's limit
    };

    double stiffness(const Contact& contact) const;
    Vec3 way(const Contact& contact, const Field& x) const;
    Force force(const Contact& contact, const Field& x) const;
    Mat3 hessian(const Contact& contact, const Force& force) const;

    const Field* x_n_ = nullptr;
    double dt_ = 0;
    std::vector<Contact> contacts_;  // by place
    std::vector<Mat3> hessians_;     // (#contacts)
};

}  // namespace sim
