// Where a body may touch itself.
#pragma once

#include "sim/contact/own_frame.h"
#include "sim/contact/vertex_block.h"

#include <vector>

namespace sim {

/// Tells cheaply which vertices of a body may be in a domain that is no neighbour at rest (contact_search.h), or a quarter
/// of a domain beyond it. However flat a domain is pressed, it reaches no further: layers that lie close to each other
/// because what is between them is thin do not count.
///
/// The answer depends on x alone; what earlier calls have found only saves work. Blocks of domains are followed: the
/// distances of one block's vertices from the domains of another are looked at again when the two may have neared each
/// other by what was between them. Neighbours move with each other, so that most of it lasts long; and while nothing has
/// moved much, seen from the whole body, there is nothing to do but to pass over the corners once.
class FoldWatch {
  public:
    explicit FoldWatch(const ContactSurface& surface);

    /// Ascending; none of a body that is not folded.
    std::vector<int> strangers(const Field& x);

  private:
    /// A vertex that was near a stranger when its gap (Hull::gap) was looked at.
    struct Near {
        int vertex = 0, domain = 0;
        double gap = 0;  // then [m]
    };

    /// The vertices of one block and the domains of another.
    struct BlockPair {
        int of_vertices = 0, of_domains = 0;
        std::vector<Near> near = {};
        double apart = 0;   // least gap of all that is not `near`, when it was looked at [m]
        double change = 0;  // of gaps since, at most [m]
    };

    // By how much any gap has changed since follow(), at most: a bound by one pass, and a closer one that sees all corners.
    double change_at_most(const Field& x);
    double see(const Field& x);
    void follow();
    void add_changes();
    void list_pairs();
    void look_at_used_up();
    void look_at(const std::vector<BlockPair*>& pairs) const;  // of the same domains
    bool is_in(const Near& near, const Field& x) const;
    // From values at the body's corners.
    std::array<Vec3p, 8> at_continued(int p, const Field& values) const;
    PaddedBounds of_continued(const std::vector<int>& domains, const Field& values) const;

    const ContactSurface* surface_;
    double of_vertex_ = 1;  // the most that one moves, when its corners move by 1
    double of_gaps_ = 1;    // the most that a gap changes, when no two corners part by more
    std::vector<VertexBlock> vertex_blocks_;       // of neighbours at rest
    std::vector<std::vector<int>> domain_blocks_;  // the same
    Field from_rest_centre_;                       // (#corners) [m]

    OwnFrame now_;  // of the last x
    // When all corners were last seen: their places (#corners), frame, how far they were apart, and by how much gaps had
    // changed at most since blocks were followed   [m]
    Field x_seen_;
    OwnFrame frame_seen_;
    double wide_seen_ = 0, change_seen_ = 0;
    // (#corners) in the body's own frame: then, when blocks were followed, and the difference [m]
    Field seen_, followed_, moved_;
    double left_ = 0;               // of gaps that are not in nearest_, then [m]
    std::vector<Near> nearest_;     // with what was left of their gaps then
    std::vector<BlockPair> pairs_;  // not far from each other, by domains, then vertices
    double unlisted_change_ = 0;    // of gaps of all others since pairs were listed [m]
};

}  // namespace sim
