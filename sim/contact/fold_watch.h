// Where a body may touch itself.
#pragma once

#include "sim/contact/look_ahead.h"
#include "sim/contact/own_frame.h"
#include "sim/contact/shell_tree.h"

#include <vector>

namespace sim {

/// Tells cheaply which vertices of a body may be in a domain that is no neighbour at rest (neighbourhood), or a quarter
/// of a domain beyond it. However flat a domain is pressed, it reaches no further: layers that lie close to each other
/// because what is between them is thin do not count.
///
/// The answer depends on x alone; what earlier calls have found only saves work. A look lists all vertices that are not
/// far from a stranger, and holds as long as no two corners of the body have parted or neared each other, seen from the body
/// itself, by more than how far away the others were: while nothing has moved much there is nothing to do but to pass over
/// the corners once.
class FoldWatch {
  public:
    explicit FoldWatch(const ContactSurface& surface);

    /// Ascending; none of a body that is not folded. x is finite.
    std::vector<int> strangers(const Field& x);

  private:
    /// A vertex that was near a stranger, and its gap (Hull::gap).
    struct Near {
        int vertex = 0, domain = 0;
        double gap = 0;  // [m]
    };

    // By how much any gap has changed since look(), at most: a bound by one pass, and a closer one that sees all corners.
    double change_at_most(const Field& x);
    double see(const Field& x);
    double most_strained() const;  // corners of a domain since the last look [m]
    void look(double within);
    void look_at(int group, double within, std::vector<Near>& near) const;
    bool is_in(const Near& near, const Field& x) const;

    const ContactSurface* surface_;
    // A gap changes by no more than two corners part, plus this many times what corners of one domain part: the weights of
    // a place beyond a domain sum to 1 + e above zero and to -e below, so it moves as a mean of corners and e times what
    // they part.
    double of_strain_ = 0;
    Field from_rest_centre_;  // (#corners) [m]
    ShellTree tree_;

    OwnFrame now_;  // of the last x
    // When all corners were last seen: their places (#corners), in the body's own frame as well, that frame, how far they
    // were apart, and by how much gaps had changed at most since the last look   [m]
    Field x_seen_, seen_;
    OwnFrame frame_seen_;
    double wide_seen_ = 0, change_seen_ = 0;
    // At the last look: corners in the body's own frame (#corners) [m], vertices near a stranger, and how near the others are
    // not.
    Field looked_at_;
    std::vector<Near> nearest_;
    LookAhead ahead_;
};

}  // namespace sim
