// Contact between bodies on a background grid: impulses on velocities.
#pragma once

#include "sim/base/field.h"
#include "sim/contact/impulses.h"
#include "sim/scene.h"

#include <vector>

namespace sim {

/// The corners [begin, end) of one body.
struct ContactBody {
    int begin = 0, end = 0;
};

/// Two bodies that may meet, and the cells of the grid on which they do.
struct GridPair {
    ContactBody first, second;
    double cell_size = 0;  // [m]
    Friction friction;
};

/// What every corner brings into contact; all indexed by corner.
struct ContactFields {
    const Field& x;                      // positions that tell the weights and normals [m]
    const Field& mass;                   // [kg]
    const std::vector<double>& volume;   // at rest [m³]
    const std::vector<double>& outside;  // distance out of the body's surface at rest [m]
};

/// All corners of a pair, free ones too, deposit mass and momentum on a grid. At a node where two bodies are
/// present, approach each other, and overlap along the normal by the end of the step (largest n·x of the one against
/// smallest of the other), impulses end the approach, with Coulomb friction. They act on the degrees of freedom: what is
/// asked of a body at a node is Σ_c w_c m_c v_c / Σ_c w_c m_c of its corners, v_c = T q, and what it gets goes back by the same
/// weights, so that momentum is exact. All that meet are settled together (Impulses), and what these bring together then.
///
/// The normal is that of g1/V1 - g2/V2, with V = Σ_c V_c w_ic of a body and g its gradient, by quadratic splines; or of g1 or
/// -g2 alone where along it the bodies overlap by much less. At the rim of one body the mean leans: a block that slides would
/// plough through the face under it, and with friction 0 come to a halt. Volume instead of mass [Z18], so that density
/// does not turn it.
///
/// What it reaches (test_grid_contact.cpp): where corners are free a block slides down another by mu = 0, 0.1 and sticks by
/// 0.5 within 1% of Coulomb's law, 3% where they are slaved; nearer than 1.5 cells to an edge of the lower one it also
/// drifts, and misses by 6%. It rests within 0.01 domain edges, slaved 0.05. Corners alone are seen: two cubes that meet
/// with a face on a face get 0.02 edges into each other at a fifth of the speed of waves, 0.2 at that speed; a rim between
/// two rows of the other's corners 0.25 to 0.4, and up to 2. Contact between surfaces keeps to 0.02.
///
/// In implicit steps these impulses only tell where contact is, and what is left of it: see GridHold.
///
/// Holds for one step, of several drifts where the map T serves for as many: map and `corners` must stay as they are as long
/// as it lives.
class GridContact {
  public:
    /// Throws Error(Diverged) where two bodies spread over more cells than can be held.
    GridContact(const std::vector<GridPair>& pairs, const ContactFields& corners);
    ~GridContact();

    /// Whether no two bodies are near each other.
    bool is_empty() const;

    /// The corners that bodies are near each other with, ascending.
    const std::vector<int>& corners() const { return corners_; }

    /// Changes velocities q of the degrees of freedom (#dofs), and v = T q at corners() (#C), which would move these from x
    /// in a drift of dt [m/s]; returns whether bodies meet. `impulses` are the same as long as it lives.
    bool restrain(Impulses& impulses, const Field& x, double dt, Field& q, Field& v);

    /// Where bodies have met in the last restrain().
    struct Meeting {
        int pair = 0, node = 0;
        int impulse = 0;  // its number
        Impulses::Touch touch;
    };

    const std::vector<Meeting>& meetings() const { return meetings_; }

    /// What the second body from the first, p - o, is there: the mean velocities of their corners.
    std::vector<Impulses::Share> shares_of(const Meeting& meeting);

  private:
    class Pair;
    ContactFields fields_;
    std::vector<Pair> pairs_;
    std::vector<int> corners_;
    std::vector<Meeting> meetings_;
};

}  // namespace sim
