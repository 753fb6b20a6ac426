#include "assets/mesh/joined_corners.h"

#include "assets/mesh/edges.h"

#include <algorithm>
#include <numeric>

namespace assets {
namespace {

// A forest of disjoint sets. The lowest corner is the root, so that nothing depends on the order of joins.
class CornerSets {
  public:
    explicit CornerSets(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

    int root(int corner) {
        while (parent_[corner] != corner)
            corner = parent_[corner] = parent_[parent_[corner]];
        return corner;
    }

    void join(int a, int b) {
        const auto [low, high] = std::minmax({root(a), root(b)});
        parent_[high] = low;
    }

  private:
    std::vector<int> parent_;
};

}  // namespace

std::vector<int> joined_corners(const std::vector<std::array<int, 3>>& triangles,
                                const std::function<bool(int, int)>& is_smooth) {
    CornerSets sets(3 * triangles.size());
    const auto corner_at = [&](int t, int vertex) {
        const auto& triangle = triangles[t];
        return 3 * t
               + static_cast<int>(std::find(triangle.begin(), triangle.end(), vertex)
                                  - triangle.begin());
    };
    const std::vector<EdgeUse> uses = sorted_edge_uses(triangles);
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() != 2 || !is_smooth(edge[0].triangle, edge[1].triangle))
            return;
        for (const int vertex : {edge[0].low, edge[0].high})
            sets.join(corner_at(edge[0].triangle, vertex), corner_at(edge[1].triangle, vertex));
    });
    std::vector<int> lowest(3 * triangles.size());
    for (int corner = 0; corner < static_cast<int>(lowest.size()); ++corner)
        lowest[corner] = sets.root(corner);
    return lowest;
}

}  // namespace assets
