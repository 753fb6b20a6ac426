// T q: from degrees of freedom to corners.
#include "sim/grid/corner_map.h"

#include "sim/base/parallel.h"
#include "sim/grid/group_sums.h"
#include "sim/grid/kernel.h"

#include <algorithm>

namespace sim {

namespace {

constexpr int group_chunk = 256, listed_chunk = 2048;

/// Whether any entry of n vectors is not zero.
[[gnu::always_inline]] inline bool moves(const Vec3p* v, int n) {
    using Bits = long long __attribute__((vector_size(sizeof(Vec3p))));
    Bits any{};
    for (int a = 0; a < n; ++a)
        any |= __builtin_bit_cast(Bits, v[a]);
    return (any[0] | any[1] | any[2] | any[3]) != 0;
}

/// Σ_a w_a v_a over the eight nodes of a linear stencil.
[[gnu::always_inline]] inline Vec3p trilinear_sum(const std::array<double, 8>& w,
                                                  const Vec3p* v) {
    return ((w[0] * v[0] + w[1] * v[1]) + (w[2] * v[2] + w[3] * v[3]))
           + ((w[4] * v[4] + w[5] * v[5]) + (w[6] * v[6] + w[7] * v[7]));
}

/// Σ_i w_i v_i of a stencil at t.
template <class S>
[[gnu::always_inline]] inline Vec3p spline_sum(const Vec3p& t, const Vec3p* v) {
    constexpr int n = S::n;
    Vec3p w[n], sum{};
    S::weights(t, w);
#pragma GCC unroll 4
    for (int c = 0; c < n; ++c) {
        Vec3p plane{};
#pragma GCC unroll 4
        for (int b = 0; b < n; ++b)
            plane += w[b][1] * row_sum<n>(w, v + n * (n * c + b));
        sum += w[c][2] * plane;
    }
    return sum;
}

}  // namespace

/// write(corner, its entry of T q).
template <class Write>
void CornerMap::visit_corners(const Field& q, const Write& write) const {
    for_chunks(n_free(), node_chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            write(free_corner_[k], q[k]);
    });
    visit_slaves<false>(q, write);
}

/// The same at slaves of a body alone; at all, or at those of stencils of which a node moves.
template <bool passes_by_rest, class Write>
void CornerMap::visit_slaves(const Part& part, const Field& q, const Write& write) const {
    visit_spline(part.kernel, [&]<class S>(S) {
        constexpr int n = S::n, per_group = n * n * n;
        for_chunks(part.last_group - part.first_group, group_chunk, [&](int begin, int end) {
            for (int k = begin; k < end; ++k) {
                const Group& group = groups_[part.first_group + k];
                const int* nodes = &group_nodes_[part.first_entry + k * per_group];
                Vec3p v[per_group];
                for (int a = 0; a < per_group; ++a)
                    v[a] = q[nodes[a]];
                if (passes_by_rest && !moves(v, per_group))
                    continue;
                for (int s = group.begin; s < group.end; ++s)
                    if constexpr (n == 2)
                        write(slave_corner_[s],
                              trilinear_sum(trilinear_weights_[part.first_trilinear + s], v));
                    else
                        write(slave_corner_[s], spline_sum<S>(slave_local_[s], v));
            }
        });
    });
}

template <bool passes_by_rest, class Write>
void CornerMap::visit_slaves(const Field& q, const Write& write) const {
    for (const Part& part : parts_)
        visit_slaves<passes_by_rest>(part, q, write);
}

/// The same at corners of a list.
template <class Write>
void CornerMap::visit_listed(std::span<const int> corners,
                             const Field& q,
                             const Write& write) const {
    for_chunks(static_cast<int>(corners.size()), listed_chunk, [&](int begin, int end) {
        for (const int c : corners.subspan(begin, end - begin)) {
            if (const int i = dof_of_corner_[c]; i >= 0) {
                write(c, q[i]);
                continue;
            }
            const int slave = slave_of_corner_[c], group = group_of_slave_[slave];
            const Part& part = part_of(group);
            visit_spline(part.kernel, [&]<class S>(S) {
                constexpr int per_group = S::n * S::n * S::n;
                const int* nodes =
                    &group_nodes_[part.first_entry + (group - part.first_group) * per_group];
                Vec3p v[per_group];
                for (int a = 0; a < per_group; ++a)
                    v[a] = q[nodes[a]];
                if constexpr (S::n == 2)
                    write(c,
                          trilinear_sum(trilinear_weights_[part.first_trilinear + slave], v));
                else
                    write(c, spline_sum<S>(slave_local_[slave], v));
            });
        }
    });
}

const CornerMap::Part& CornerMap::part_of(int group) const {
    return *std::find_if(
        parts_.begin(), parts_.end(), [&](const Part& p) { return group < p.last_group; });
}

void CornerMap::apply(const Field& q, Field& u) const {
    visit_corners(q, [&](int c, const Vec3p& v) { u[c] = v; });
}

void CornerMap::move(const Field& x_n, double dt, const Field& q, Field& x) const {
    x.resize(x_n.size());
    visit_corners(q, [&](int c, const Vec3p& v) { x[c] = x_n[c] + dt * v; });
}

void CornerMap::move_bodies(std::span<const int> bodies,
                            const Field& x_n,
                            double dt,
                            const Field& q,
                            Field& x,
                            Field* u) const {
    x.resize(x_n.size());
    const auto visit = [&](const auto& write) {
        for (const int b : bodies) {
            const Part& part = parts_[b];
            for_chunks(part.last_free - part.first_free, node_chunk, [&](int begin, int end) {
                for (int k = part.first_free + begin; k < part.first_free + end; ++k)
                    write(free_corner_[k], q[k]);
            });
            visit_slaves<false>(part, q, write);
        }
    };
    if (u == nullptr)
        return visit([&](int c, const Vec3p& v) { x[c] = x_n[c] + dt * v; });
    u->resize(x_n.size());
    visit([&](int c, const Vec3p& v) {
        (*u)[c] = v;
        x[c] = x_n[c] + dt * v;
    });
}

void CornerMap::apply_at(std::span<const int> corners, const Field& q, Field& u) const {
    visit_listed(corners, q, [&](int c, const Vec3p& v) { u[c] = v; });
}

void CornerMap::add_applied_at(std::span<const int> corners, const Field& q, Field& u) const {
    visit_listed(corners, q, [&](int c, const Vec3p& v) { u[c] += v; });
}

void CornerMap::apply_to_slaves(const Field& q, Field& u) const {
    visit_slaves<false>(q, [&](int c, const Vec3p& v) { u[c] = v; });
}

void CornerMap::add_applied(const Field& q, Field& u) const {
    for_chunks(n_free(), node_chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            u[free_corner_[k]] += q[k];
    });
    visit_slaves<true>(q, [&](int c, const Vec3p& v) { u[c] += v; });
}

void CornerMap::find_row(int corner, std::vector<Weight>& row) const {
    row.clear();
    if (const int i = dof_of_corner_[corner]; i >= 0) {
        row.push_back({i, 1});
        return;
    }
    const int slave = slave_of_corner_[corner], group = group_of_slave_[slave];
    const Part& part = part_of(group);
    visit_spline(part.kernel, [&]<class S>(S) {
        constexpr int n = S::n, per_group = n * n * n;
        const int* nodes =
            &group_nodes_[part.first_entry + (group - part.first_group) * per_group];
        Vec3p w[n];
        S::weights(slave_local_[slave], w);
        for (int a = 0; a < per_group; ++a)
            row.push_back({nodes[a], w[a % n][0] * (w[a / n % n][1] * w[a / (n * n)][2])});
    });
}

const Field& CornerMap::applied(const Field& q, Field& buffer) const {
    if (is_identity())
        return q;
    buffer.resize(dof_of_corner_.size());
    apply(q, buffer);
    return buffer;
}

}  // namespace sim
