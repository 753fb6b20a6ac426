// What T q, Tᵀ f and gradients share: sums over groups of slaves, and along rows of nodes.
#pragma once

#include "sim/base/parallel.h"
#include "sim/grid/corner_map.h"

#include <algorithm>

namespace sim {

constexpr int group_block = 32;  // that a pass over slaves keeps in the cache
constexpr int node_chunk = 4096;

/// Σ_a w_a v_a along a row of nodes.
template <int n>
[[gnu::always_inline]] inline Vec3p row_sum(const Vec3p* w, const Vec3p* v) {
    Vec3p sum = w[0][0] * v[0];
    for (int a = 1; a < n; ++a)
        sum += w[a][0] * v[a];
    return sum;
}

/// How many groups sum together: of large bodies more, as every chunk meets whole layers of nodes. Whole blocks.
inline int groups_per_sum(int n_groups) {
    constexpr int least = 256, most_chunks = 64;
    const int blocks = (n_groups + group_block * most_chunks - 1) / (group_block * most_chunks);
    return std::max(least, group_block * blocks);
}

template <class Sum>
void CornerMap::sum_groups(const Part& part, int per_group, const Sum& sum, Field& sums) const {
    const int n_groups = part.last_group - part.first_group, size = groups_per_sum(n_groups);
    const int n_chunks = (n_groups + size - 1) / size;
    if (static_cast<int>(shares_.size()) < n_chunks)
        shares_.resize(n_chunks);
    for_chunks(n_groups, size, [&](int begin, int end) {
        const int* nodes = group_nodes_.data() + part.first_entry;
        int low = nodes[begin * per_group], high = low;
        for (int k = begin * per_group; k < end * per_group; ++k) {
            low = std::min(low, nodes[k]);
            high = std::max(high, nodes[k]);
        }
        Shares& shares = shares_[begin / size];
        shares.first = low;
        shares.sums.assign(high + 1 - low, Vec3p{});
        sum(begin, end, shares);
    });
    for_chunks(part.last_node - part.first_node, node_chunk, [&](int begin, int end) {
        const int first = n_free() + part.first_node;
        for (int k = 0; k < n_chunks; ++k) {
            const Shares& shares = shares_[k];
            const int last = std::min(first + end, shares.first + int(shares.sums.size()));
            for (int i = std::max(first + begin, shares.first); i < last; ++i)
                sums[i] += shares.sums[i - shares.first];
        }
    });
}

}  // namespace sim
