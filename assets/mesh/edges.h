// The edges of a triangle mesh, found by sorting: which triangles use each, and the loops they
// form.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace assets {

/// One triangle's use of the edge between the vertices low < high.
struct EdgeUse {
    int low, high;
    int triangle;
    bool forward;  // the triangle runs from low to high

    int from() const { return forward ? low : high; }

    int to() const { return forward ? high : low; }

    bool same_edge(const EdgeUse& other) const {
        return low == other.low && high == other.high;
    }
};

/// The three uses of every triangle, sorted by edge, then triangle. Each triangle has three
/// distinct vertices. (3 #T)
std::vector<EdgeUse> sorted_edge_uses(const std::vector<std::array<int, 3>>& triangles);

/// Calls visit(std::span<const EdgeUse>) with the uses of each edge in turn; `uses` as sorted
/// above.
template <class Visit>
void for_each_edge(std::span<const EdgeUse> uses, Visit visit) {
    for (size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        while (end < uses.size() && uses[end].same_edge(uses[begin]))
            ++end;
        visit(uses.subspan(begin, end - begin));
    }
}

/// Whether every edge has exactly two triangles, oppositely directed; false where there is none.
bool is_closed(const std::vector<std::array<int, 3>>& triangles);

/// Simple loops (no vertex twice) that head to tail join the directed `uses`, each use in one loop
/// at most. Uses that end in a vertex without a way on are in none. Depends on nothing but the
/// order of `uses`.
std::vector<std::vector<EdgeUse>> simple_loops(std::span<const EdgeUse> uses);

}  // namespace assets
