// Where a body may touch itself.
#pragma once

#include "sim/contact/contact_surface.h"

#include <vector>

namespace sim {

/// Tells cheaply which vertices of a body may be in a domain that is no neighbour at rest (contact_search.h), or a quarter
/// of a domain beyond it. However flat a domain is pressed, it reaches no further: layers that lie close to each other
/// because what is between them is thin do not count.
///
/// The answer depends on x alone; that of earlier calls only saves work.
class FoldWatch {
  public:
    explicit FoldWatch(const ContactSurface& surface);

    /// Ascending; none of a body that is not folded.
    const std::vector<int>& strangers(const Field& x);

  private:
    /// A vertex that was near a stranger when all distances were looked at.
    struct Near {
        int vertex = 0, domain = 0;
        double distance = 0;  // then, less than `watched` [m]
    };

    struct OwnFrame;
    std::vector<int> find_strangers(const Field& x);
    void see(const Field& x, const OwnFrame& frame);
    /// Of a distance since all were looked at, at most; found with less effort where it is below `enough`.   [m]
    double most_change(double enough) const;
    double most_strained() const;  // of corners, seen from the centres of their domains [m]
    std::vector<Near> look_around(const OwnFrame& frame, const Field& x) const;

    const ContactSurface* surface_;
    double of_vertex_ = 1;  // the most that one moves, when its corners move by 1
    Field seen_,
        looked_at_;  // (#corners) now, and when all distances were looked at, or empty [m]
    std::vector<Near> near_;  // by vertex
    Field from_rest_centre_;  // (#corners) [m]
    Field asked_;             // (#corners) the last x [m]
    std::vector<int> found_;  // the answer
};

}  // namespace sim
