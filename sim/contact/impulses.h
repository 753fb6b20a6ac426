// Impulses of contact on the velocities of the degrees of freedom.
#pragma once

#include "assets/base/vector_types.h"
#include "sim/base/field.h"
#include "sim/grid/corner_map.h"
#include "sim/scene.h"

#include <span>
#include <vector>

namespace sim {

/// What contacts take from velocities q that would move bodies into what they touch in an explicit step of dt: impulses
/// that end the step where they touch, and friction of up to mu times as much, by projected Gauss-Seidel sweeps. Inelastic,
/// so that no energy comes of it (Moreau's stepping). Impulses act through the map, as only what it lets through moves
/// corners: a corner that were given more would ask for the same again, and pile up speed.
class Impulses {
  public:
    /// What touches, p, against what is touched, o.
    struct Touch {
        Vec3 normal{0, 0, 1};  // unit, out of o
        double gap = 0;   // of p - o along it at the start of the step, negative inside [m]
        double edge = 0;  // of a domain, for tolerances [m]
        Friction friction;
        Vec3 carried{0, 0, 0};  // velocity of o where no degree of freedom moves it [m/s]
    };

    /// p - o moves by Σ weight v_corner.
    struct Share {
        int corner = 0;
        double weight = 0;
    };

    /// What moves p - o in the degrees of freedom: a range of weights, each of another one, and the inverse of the mass that
    /// they push in each direction [1/kg].
    struct Row {
        int first = 0, last = 0;
        Vec3p inverse_mass{};
    };

    /// `inverse_mass` [1/kg] and `is_free`, 1 or 0 in each component, are of degrees of freedom. All are referred to.
    Impulses(const CornerMap& map,
             const std::vector<double>& inverse_mass,
             const Field& is_free);

    /// Forgets all impulses: those that follow are of a drift of dt. Rows stay, as long as the map does.
    void begin_drift(double dt);

    std::size_t size() const { return impulses_.size(); }

    /// Of one corner alone, the same whenever it is asked for; and of several.
    Row row_of(int corner);
    Row row_of(std::span<const Share> shares);

    /// Returns the number of the impulse; -1 where p - o is held on all sides.
    int add(const Touch& touch, const Row& row);

    /// What one has come to: along the normal, and across it, on p - o.   [N s]
    struct Settled {
        double push = 0;
        Vec3 hold{0, 0, 0};
    };

    Settled operator[](int number) const {
        return {impulses_[number].push, impulses_[number].hold};
    }

    /// The mass that one pushes along its normal.   [kg]
    double mass(int number) const { return 1 / impulses_[number].inverse_along; }

    /// Settles all, also those of earlier calls, until none changes a depth by more than 1e-4 domain edges. Returns by how
    /// much any v = T q changes, at most.   q (#dofs) [m/s]
    double settle(Field& q);

    /// The same, while v follows: everywhere, or at the corners listed.   v (#C) [m/s]
    double settle(Field& q, Field& v);
    double settle(Field& q, std::span<const int> corners, Field& v);

  private:
    struct Impulse {
        Touch touch;
        Row row;
        double inverse_along = 0, inverse_across = 0;  // mass that is pushed and held [1/kg]
        double push = 0;                               // along the normal, never negative [N s]
        Vec3 hold{0, 0, 0};                            // across it [N s]
    };

    void sweep(Field& q);
    double settle(Impulse& impulse, Field& q) const;

    Vec3p inverse_mass(int dof) const { return inverse_mass_[dof] * is_free_[dof]; }

    const CornerMap& map_;
    const std::vector<double>& inverse_mass_;
    const Field& is_free_;
    double dt_ = 0;
    std::vector<Impulse> impulses_;
    std::vector<CornerMap::Weight> weights_;
    // Empty until a row is asked for: in most steps of most bodies nothing touches.
    std::vector<int> row_of_corner_;  // (#C) in rows_, -1 where it has not been asked for
    std::vector<Row> rows_;
    std::vector<int> place_;  // (#dofs) in weights_ of the sum that is being made, -1: none
    std::vector<CornerMap::Weight> row_;
    Field change_;  // (#dofs) of q
};

}  // namespace sim
