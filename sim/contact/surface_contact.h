// Bodies against each other and themselves, as an energy inside the solve: fine surface against the other's inside.
#pragma once

#include "sim/contact/contact_energy.h"
#include "sim/contact/contact_point.h"
#include "sim/contact/fold_watch.h"
#include "sim/contact/grip.h"
#include "sim/contact/impulses.h"
#include "sim/contact/near_domain_lists.h"
#include "sim/contact/padded_bounds.h"
#include "sim/contact/pair_friction.h"
#include "sim/grid/corner_map.h"

#include <optional>
#include <vector>

namespace sim {

/// The energy k/2 d² that a vertex of a pair of bodies had at the end of a step.   [J]
struct HeldContact {
    int pair = 0, vertex = 0;
    double energy = 0;
};

/// Σ over vertices of one body inside another of  k/2 d² + friction (Grip),   d = max(0, -(gap + n·(p - o))).
///
/// d is linear in the corners while gap, n and the weights of ContactPoint are held: linearised where the step is expected
/// to end, the energy is convex, and the solve is repeated where it has gone far from there (relinearize). Momentum is
/// exact by construction, angular momentum as p = o there. k = hardness 40 E A / s for a vertex of area A, more where bodies
/// meet faster than waves spread.
///
/// A new linearisation may find a vertex deeper where the step starts than the step before had left it: where a fold opens
/// on vertices that had slipped in unseen, where a vertex comes round an edge, or at the very start. To push it out at once
/// would make energy of nothing. So the gap is shifted until the step starts with no more energy than the one before ended
/// with (HeldContact), and comes back slowly (rest_recovery, impact_recovery): else a step of backward Euler can only lose energy.
class SurfaceContact : public ContactEnergy {
  public:
    SurfaceContact(std::vector<ContactSurface> bodies,
                   const PairFriction& friction,
                   double hardness);
    SurfaceContact(const SurfaceContact&) = delete;  // its parts refer to each other
    SurfaceContact& operator=(const SurfaceContact&) = delete;

    bool empty() const { return bodies_.empty(); }

    /// Whether nothing is near anything where the step is expected to end.
    bool finds_none() const { return contacts_.empty(); }

    /// What a step starts with, all of the field of corners.
    struct Start {
        const Field &x, &v;                    // [m], [m/s]
        const std::vector<double>& top_speed;  // (#bodies) lately [m/s]
        const std::vector<HeldContact>& held;  // ascending
    };

    /// Looks where bodies are and how they move: before largest_step() and begin_step() of the same start.
    void see(const Start& start) { extents_ = extents(start.x, start.v); }

    /// Bodies are near as well where they are at x (#C): a long step may have led there faster than see() could tell.
    void see_end(const Field& x);

    /// The longest step that moves no vertex further into a body that it may touch than a part of its thickness.   [s]
    double largest_step(const Start& start, double dt);

    /// Finds what may touch in the step to about x_expected (#C) of length dt [s].
    void begin_step(const Start& start, const Field& x_expected, double dt);

    /// Linearises anew at x. Returns by how much depths differ from those of the old linearisation, at most, as a share
    /// of the domain's edge. In the bottom of a valley a vertex is nearest to one side, then, when that keeps it out, to the
    /// other, and so on: from the second time on in a step, planes that it has met before hold as well.
    double relinearize(const Field& x);

    /// Whether relinearize(x) is known to return less than `tolerance`, where no corner is further than `way` [m] from where
    /// the old linearisation was made. Knows more cheaply: of most contacts because they have hardly moved.
    bool is_linear_enough(const Field& x, double way, double tolerance);

    double add_gradient(const Field& x, Field& gradient) const override;
    void linearize(const Field& x) override;
    void add_product(const Field& u, Field& product) const override;
    void add_diagonal(Field& diagonal) const override;

    /// What the next step starts with where this one ends at x, ascending.
    std::vector<HeldContact> held(const Field& x) const;

    /// Whether any vertex is inside what it may touch at x.
    bool touches(const Field& x) const;

    /// Whether a vertex has begun or ceased to touch since the start of the step that has led to x.
    bool has_changed_touch(const Field& x) const;

    /// Takes from velocities q of the degrees of freedom, and v = T q of the corners, what would move vertices into domains in
    /// the explicit step, by `impulses`. Returns by how much any q has changed [m/s], at most; none where there
    /// was nothing to take.
    std::optional<double> restrain(Impulses& impulses, Field& q, Field& v) const;

    /// Deepest penetration and smallest gap at x, as shares of the domain's edge; gaps are known up to `reach`.
    struct Report {
        double penetration = 0, gap = reach;
    };

    static constexpr double reach = 1;  // in domain edges
    Report report(const Field& x);

  private:
    struct Contact : ContactPoint {
        int pair = 0, index = 0;  // of the vertex in its body
        double stiffness = 0;     // k [N/m]
        Grip grip;                // of p - o
        // At the start of the step: along the normal, negative inside, and how deep that is.   [m]
        double start_gap = 0, start_depth = 0;

        std::pair<int, int> key() const { return {pair, index}; }
    };

    struct Pair {
        int of_vertices = 0, of_domains = 0;  // bodies
        Friction friction;
        bool is_near = false;  // two bodies that may touch in this step
        double margin = 0, recovery = 0, top_speed = 0;  // of this step [m], [m], [m/s]

        bool is_self() const { return of_vertices == of_domains; }
    };

    /// Where a body is and how it moves.
    struct Extent {
        PaddedBounds bounds;
        Vec3 velocity{0, 0, 0};  // mean of the corners [m/s]
        double most_spread = 0;  // at least `spread`, from a box around the velocities [m/s]
        // Of the corners' velocities around it, at most [m/s]
        std::optional<double> spread = {};
    };

    /// Of the Hessian, where it is not zero.
    struct Row {
        const Contact* contact = nullptr;
        Mat3 hessian;  // on p - o
    };

    std::vector<Extent> extents(const Field& x, const Field& v) const;
    /// The speed at which corners of two bodies near each other, at most, and a bound of it that costs nothing.   [m/s]
    double approach(const Pair& pair, const Field& v);
    double most_approach(const Pair& pair) const;
    double spread(int body, const Field& v);
    /// Of bounds.   [m]
    static double distance(const Pair& pair, const std::vector<Extent>& extents);

    /// Whether a body may touch itself within dt, when no two of its corners near each other by more than `way` [m].
    bool may_fold(const Pair& pair, const Start& start, double way, double dt);
    void find(const Field& x);
    std::vector<ContactPoint> found(const Pair& pair, const Field& x);
    const NearDomains& near(const Pair& pair, const Field& x);
    /// By how much depths of two lists in the order of pairs and vertices differ at x, at most, in domain edges.
    static double mismatch(const std::vector<Contact>& before,
                           const std::vector<Contact>& after,
                           const Field& x);
    /// Adds those of a list whose planes are not among the contacts of their vertices.
    void keep(const std::vector<Contact>& before);
    Contact prepared(const ContactPoint& point, int pair) const;
    double held_energy(int pair, int vertex) const;

    double hardness_ = 1;
    std::vector<ContactSurface> bodies_;
    std::vector<FoldWatch> folds_;  // (#bodies)
    NearDomainLists near_;
    std::vector<Pair> pairs_;
    std::vector<Extent> extents_;    // (#bodies) at the start of the step
    std::vector<Contact> contacts_;  // by pair, then vertex, planes found last first
    int n_linearized_ = 0;           // in this step
    std::vector<Row> rows_;
    std::vector<HeldContact> held_;  // at the start of the step
    Field x_n_;
    double dt_ = 0;
};

}  // namespace sim
