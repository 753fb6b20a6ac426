#include "assets/mesh/joined_corners.h"

#include "assets/base/disjoint_sets.h"
#include "assets/mesh/edges.h"

#include <algorithm>

namespace assets {

std::vector<int> joined_corners(const std::vector<std::array<int, 3>>& triangles,
                                const std::function<bool(int, int)>& is_smooth) {
    DisjointSets sets(3 * triangles.size());
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
