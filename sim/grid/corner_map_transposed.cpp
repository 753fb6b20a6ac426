// Tᵀ f: from corners to degrees of freedom.
#include "sim/grid/corner_map.h"
#include "sim/grid/group_sums.h"
#include "sim/grid/kernel.h"

#include <algorithm>

namespace sim {

namespace {

/// A slave's value with the weights of its stencil, or their squares, in one axis after the other.
template <class S>
struct Weighted {
    Vec3p w[S::n], value;

    Weighted(const Vec3p& t, const Vec3p& value_there, bool squared) : value(value_there) {
        S::weights(t, w);
        if (squared)
            for (Vec3p& weight : w)
                weight *= weight;
    }

    [[gnu::always_inline]] void add_to_plane(int c, Vec3p* sum) const {
        const Vec3p plane = w[c][2] * value;
#pragma GCC unroll 4
        for (int b = 0; b < S::n; ++b) {
            const Vec3p row = w[b][1] * plane;
#pragma GCC unroll 4
            for (int a = 0; a < S::n; ++a)
                sum[S::n * b + a] += w[a][0] * row;
        }
    }
};

}  // namespace

template <bool squared, class Value>
void CornerMap::gather_linear(const Part& part,
                              const Group& group,
                              const int* nodes,
                              const Value& value,
                              Shares& shares) const {
    Vec3p sum[8] = {};
    for (int s = group.begin; s < group.end; ++s) {
        const auto& w8 = trilinear_weights_[part.first_trilinear + s];
        const Vec3p there = value(slave_corner_[s]);
#pragma GCC unroll 8
        for (int a = 0; a < 8; ++a)
            sum[a] += (squared ? w8[a] * w8[a] : w8[a]) * there;
    }
    for (int a = 0; a < 8; ++a)
        shares.at(nodes[a]) += sum[a];
}

template <class S, bool squared, class Value>
void CornerMap::gather(const Part& part, const Value& value, Field& q) const {
    constexpr int n = S::n, per_group = n * n * n;
    const auto sum_chunk = [&](int begin, int end, Shares& shares) {
        thread_local std::vector<Weighted<S>> weighted;
        for (int k = begin; k < end; ++k) {
            const Group& group = groups_[part.first_group + k];
            const int* nodes = &group_nodes_[part.first_entry + k * per_group];
            if constexpr (n == 2) {
                gather_linear<squared>(part, group, nodes, value, shares);
                continue;
            }
            weighted.clear();
            for (int s = group.begin; s < group.end; ++s)
                weighted.emplace_back(slave_local_[s], value(slave_corner_[s]), squared);
            for (int c = 0; c < n; ++c, nodes += n * n) {
                Vec3p sum[n * n] = {};
                for (const Weighted<S>& slave : weighted)
                    slave.add_to_plane(c, sum);
                for (int a = 0; a < n * n; ++a)
                    shares.at(nodes[a]) += sum[a];
            }
        }
    };
    sum_groups(part, per_group, sum_chunk, q);
}

template <bool squared, class Value>
void CornerMap::gather_nodes(const Part& part, const Value& value, Field& q) const {
    const auto nodes = q.begin() + n_free();
    std::fill(nodes + part.first_node, nodes + part.last_node, Vec3p{});
    visit_spline(part.kernel, [&]<class S>(S) { gather<S, squared>(part, value, q); });
}

template <bool squared>
void CornerMap::gather_all(const Field& f, Field& q) const {
    for_chunks(n_free(), node_chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            q[k] = f[free_corner_[k]];
    });
    for (const Part& part : parts_)
        gather_nodes<squared>(
            part, [&](int c) { return f[c]; }, q);
}

void CornerMap::gather_at_nodes(int body, const Field& f, Field& q) const {
    gather_nodes<false>(
        parts_[body], [&](int c) { return f[c]; }, q);
}

void CornerMap::gather_at_nodes(int body, const Field& f, const Field& g, Field& q) const {
    gather_nodes<false>(
        parts_[body], [&](int c) { return f[c] - g[c]; }, q);
}

void CornerMap::apply_transposed(const Field& f, Field& q) const {
    gather_all<false>(f, q);
}

void CornerMap::apply_squared_transposed(const Field& k, Field& d) const {
    gather_all<true>(k, d);
}

const Field& CornerMap::applied_transposed(const Field& f, Field& buffer) const {
    if (is_identity())
        return f;
    buffer.resize(n_dofs());
    apply_transposed(f, buffer);
    return buffer;
}

}  // namespace sim
