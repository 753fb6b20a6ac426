#include "sim/grid/corner_map.h"

#include "sim/base/parallel.h"
#include "sim/grid/kernel.h"

#include <algorithm>

namespace sim {

namespace {

constexpr int group_chunk = 256;
constexpr int group_block = 32;  // that a pass over slaves keeps in the cache
constexpr int most_chunks = 64;  // of groups that sum apart from each other
constexpr int node_chunk = 4096;
constexpr double least_moment =
    1e-6;  // in cells squared: a linear spline has none on its nodes

/// Σ_a w_a v_a along a row of nodes.
template <int n>
[[gnu::always_inline]] inline Vec3p row_sum(const Vec3p* w, const Vec3p* v) {
    Vec3p sum = w[0][0] * v[0];
    for (int a = 1; a < n; ++a)
        sum += w[a][0] * v[a];
    return sum;
}

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

/// The factors of a slave's stencil in one axis after the other, w of T and d of ∂w: see CornerMap::Factor.
template <class S>
struct Factors {
    Vec3p w[S::n], d[S::n];

    Factors() = default;

    Factors(CornerMap::Factor factor, const Vec3p& t, double cell_size) {
        S::weights(t, w);
        if (factor == CornerMap::Factor::Moment) {
            for (int a = 0; a < S::n; ++a)
                d[a] = w[a] * (a - t) * cell_size;
            return;
        }
        S::slopes(t, d);
        for (int a = 0; a < S::n; ++a)
            d[a] *= 1 / cell_size;
        if (factor == CornerMap::Factor::SlopeSquared)
            for (int a = 0; a < S::n; ++a) {
                w[a] *= w[a];
                d[a] *= d[a];
            }
    }
};

/// Σ_i v_i ∂w_i, summed along x, then y, then z.
template <class S>
[[gnu::always_inline]] inline Gradient gradient_at(const Factors<S>& at, const Vec3p* v) {
    constexpr int n = S::n;
    Gradient sum{};
#pragma GCC unroll 4
    for (int c = 0; c < n; ++c) {
        Vec3p plane[3] = {};
#pragma GCC unroll 4
        for (int b = 0; b < n; ++b, v += n) {
            const Vec3p row = row_sum<n>(at.w, v), slope = row_sum<n>(at.d, v);
            plane[0] += at.w[b][1] * slope;
            plane[1] += at.d[b][1] * row;
            plane[2] += at.w[b][1] * row;
        }
        sum.column[0] += at.w[c][2] * plane[0];
        sum.column[1] += at.w[c][2] * plane[1];
        sum.column[2] += at.d[c][2] * plane[2];
    }
    return sum;
}

/// Adds A ∂w to the nodes of rows [first, first + rows) of plane c of a stencil.
template <class S, int rows>
[[gnu::always_inline]] inline void add_to_rows(
    const Factors<S>& at, int c, int first, const Gradient& A, Vec3p* sum) {
    constexpr int n = S::n;
    const Vec3p x = at.w[c][2] * A.column[0], y = at.w[c][2] * A.column[1],
                z = at.d[c][2] * A.column[2];
#pragma GCC unroll 4
    for (int b = 0; b < rows; ++b) {
        const double w = at.w[first + b][1], d = at.d[first + b][1];
        const Vec3p along = w * x, across = d * y + w * z;
#pragma GCC unroll 4
        for (int a = 0; a < n; ++a)
            sum[n * b + a] += at.d[a][0] * along + at.w[a][0] * across;
    }
}

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

/// How many groups sum together: of large bodies more, as every chunk meets whole layers of nodes. Whole blocks.
int chunk_of(int n_groups) {
    const int blocks = (n_groups + group_block * most_chunks - 1) / (group_block * most_chunks);
    return std::max(group_chunk, group_block * blocks);
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

/// The same at slaves alone; at all, or at those of stencils of which a node moves.
template <bool passes_by_rest, class Write>
void CornerMap::visit_slaves(const Field& q, const Write& write) const {
    for (const Part& part : parts_)
        visit_spline(part.kernel, [&]<class S>(S) {
            constexpr int n = S::n, per_group = n * n * n;
            for_chunks(
                part.last_group - part.first_group, group_chunk, [&](int begin, int end) {
                    for (int k = begin; k < end; ++k) {
                        const Group& group = groups_[part.first_group + k];
                        const int* nodes = &group_nodes_[part.first_entry + k * per_group];
                        Vec3p v[per_group];
                        for (int a = 0; a < per_group; ++a)
                            v[a] = q[nodes[a]];
                        if (passes_by_rest && !moves(v, per_group))
                            continue;
                        for (int s = group.begin; s < group.end; ++s) {
                            if constexpr (n == 2) {
                                write(slave_corner_[s],
                                      trilinear_sum(
                                          trilinear_weights_[part.first_trilinear + s], v));
                                continue;
                            }
                            Vec3p w[n], sum{};
                            S::weights(slave_local_[s], w);
#pragma GCC unroll 4
                            for (int c = 0; c < n; ++c) {
                                Vec3p plane{};
#pragma GCC unroll 4
                                for (int b = 0; b < n; ++b)
                                    plane += w[b][1] * row_sum<n>(w, v + n * (n * c + b));
                                sum += w[c][2] * plane;
                            }
                            write(slave_corner_[s], sum);
                        }
                    }
                });
        });
}

void CornerMap::apply(const Field& q, Field& u) const {
    visit_corners(q, [&](int c, const Vec3p& v) { u[c] = v; });
}

void CornerMap::move(const Field& x_n, double dt, const Field& q, Field& x) const {
    x.resize(x_n.size());
    visit_corners(q, [&](int c, const Vec3p& v) { x[c] = x_n[c] + dt * v; });
}

void CornerMap::apply_and_move(
    const Field& q, Field& u, const Field& x_n, double dt, Field& x) const {
    u.resize(x_n.size());
    x.resize(x_n.size());
    visit_corners(q, [&](int c, const Vec3p& v) {
        u[c] = v;
        x[c] = x_n[c] + dt * v;
    });
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
    const int slave = slave_of_corner_[corner];
    const auto after =
        std::upper_bound(groups_.begin(), groups_.end(), slave, [](int s, const Group& g) {
            return s < g.begin;
        });
    const int group = static_cast<int>(after - groups_.begin()) - 1;
    const Part& part = *std::find_if(
        parts_.begin(), parts_.end(), [&](const Part& p) { return group < p.last_group; });
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

template <class Sum>
void CornerMap::sum_groups(const Part& part, int per_group, const Sum& sum, Field& sums) const {
    const int n_groups = part.last_group - part.first_group, size = chunk_of(n_groups);
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

template <class S, bool squared>
void CornerMap::gather(const Part& part,
                       const std::vector<char>* counts,
                       const Field& f,
                       Field& q) const {
    constexpr int n = S::n, per_group = n * n * n;
    const auto sum_chunk = [&](int begin, int end, Shares& shares) {
        thread_local std::vector<Weighted<S>> weighted;
        for (int k = begin; k < end; ++k) {
            const Group& group = groups_[part.first_group + k];
            const int* nodes = &group_nodes_[part.first_entry + k * per_group];
            if (counts != nullptr
                && std::none_of(counts->begin() + group.begin,
                                counts->begin() + group.end,
                                [](char slave_counts) { return slave_counts; }))
                continue;
            if constexpr (n == 2) {
                Vec3p sum[8] = {};
                for (int s = group.begin; s < group.end; ++s) {
                    if (counts != nullptr && !(*counts)[s])
                        continue;
                    const auto& w8 = trilinear_weights_[part.first_trilinear + s];
                    const Vec3p value = f[slave_corner_[s]];
#pragma GCC unroll 8
                    for (int a = 0; a < 8; ++a)
                        sum[a] += (squared ? w8[a] * w8[a] : w8[a]) * value;
                }
                for (int a = 0; a < 8; ++a)
                    shares.at(nodes[a]) += sum[a];
                continue;
            }
            weighted.clear();
            for (int s = group.begin; s < group.end; ++s)
                if (counts == nullptr || (*counts)[s])
                    weighted.emplace_back(slave_local_[s], f[slave_corner_[s]], squared);
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

template <bool squared>
void CornerMap::gather_nodes(const Part& part,
                             const std::vector<char>* counts,
                             const Field& f,
                             Field& q) const {
    const auto nodes = q.begin() + n_free();
    std::fill(nodes + part.first_node, nodes + part.last_node, Vec3p{});
    visit_spline(part.kernel, [&]<class S>(S) { gather<S, squared>(part, counts, f, q); });
}

template <bool squared>
void CornerMap::gather_all(const Field& f, Field& q) const {
    for_chunks(n_free(), node_chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            q[k] = f[free_corner_[k]];
    });
    for (const Part& part : parts_)
        gather_nodes<squared>(part, nullptr, f, q);
}

void CornerMap::gather_at_nodes(int body, const Field& f, Field& q) const {
    gather_nodes<false>(parts_[body], nullptr, f, q);
}

void CornerMap::apply_transposed_of(const std::vector<int>& corners,
                                    const Field& f,
                                    Field& q) const {
    std::fill(q.begin(), q.begin() + n_free(), Vec3p{});
    counts_.resize(slave_corner_.size(), 0);
    for (const int c : corners)
        if (const int k = dof_of_corner_[c]; k >= 0)
            q[k] = f[c];
        else
            counts_[slave_of_corner_[c]] = 1;
    for (const Part& part : parts_)
        gather_nodes<false>(part, &counts_, f, q);
    for (const int c : corners)
        if (dof_of_corner_[c] < 0)
            counts_[slave_of_corner_[c]] = 0;
}

void CornerMap::apply_transposed(const Field& f, Field& q) const {
    gather_all<false>(f, q);
}

void CornerMap::apply_squared_transposed(const Field& k, Field& d) const {
    gather_all<true>(k, d);
}

const Field& CornerMap::applied(const Field& q, Field& buffer) const {
    if (is_identity())
        return q;
    buffer.resize(dof_of_corner_.size());
    apply(q, buffer);
    return buffer;
}

const Field& CornerMap::applied_transposed(const Field& f, Field& buffer) const {
    if (is_identity())
        return f;
    buffer.resize(n_dofs());
    apply_transposed(f, buffer);
    return buffer;
}

template <class S>
void CornerMap::pass(
    const Part& part, Factor factor, const Field* q, const AtSlaves& f, Field* sums) const {
    constexpr int n = S::n, per_group = n * n * n;
    constexpr int rows = n == 4 ? 2 : n;  // summed at once, so that the sums live in registers
    const Group* groups = groups_.data() + part.first_group;
    const int* group_nodes = group_nodes_.data() + part.first_entry;

    // Blocks of a few groups after each other, so that all that belongs to their slaves stays in the cache.
    const auto pass_block = [&](int begin, int end, Shares* shares) {
        thread_local std::vector<Factors<S>> factors;
        thread_local std::vector<Gradient> values;
        const int first = groups[begin].begin, last = groups[end - 1].end;
        factors.clear();
        for (int s = first; s < last; ++s)
            factors.emplace_back(factor, slave_local_[s], part.cell_size);
        values.resize(last - first);
        if (q != nullptr)
            for (int k = begin; k < end; ++k) {
                Vec3p v[per_group];
                for (int a = 0; a < per_group; ++a)
                    v[a] = (*q)[group_nodes[k * per_group + a]];
                for (int s = groups[k].begin; s < groups[k].end; ++s)
                    values[s - first] = gradient_at(factors[s - first], v);
            }
        f({first, last, begin / group_block}, values.data());
        if (shares == nullptr)
            return;
        for (int k = begin; k < end; ++k) {
            const int* nodes = group_nodes + k * per_group;
            for (int c = 0; c < n; ++c)
                for (int row = 0; row < n; row += rows, nodes += rows * n) {
                    Vec3p sum[rows * n] = {};
                    for (int s = groups[k].begin; s < groups[k].end; ++s)
                        add_to_rows<S, rows>(
                            factors[s - first], c, row, values[s - first], sum);
                    for (int a = 0; a < rows * n; ++a)
                        shares->at(nodes[a]) += sum[a];
                }
        }
    };
    if (sums == nullptr) {
        for_chunks(part.last_group - part.first_group, group_block, [&](int begin, int end) {
            pass_block(begin, end, nullptr);
        });
        return;
    }
    const auto sum_chunk = [&](int begin, int end, Shares& shares) {
        for (int block = begin; block < end; block += group_block)
            pass_block(block, std::min(block + group_block, end), &shares);
    };
    sum_groups(part, per_group, sum_chunk, *sums);
}

void CornerMap::visit_gradients(int body,
                                Factor factor,
                                const Field& q,
                                const AtSlaves& visit) const {
    const Part& part = parts_[body];
    visit_spline(part.kernel, [&]<class S>(S) { pass<S>(part, factor, &q, visit, nullptr); });
}

void CornerMap::add_transposed(int body,
                               Factor factor,
                               const AtSlaves& fill,
                               Field& sums) const {
    const Part& part = parts_[body];
    visit_spline(part.kernel, [&]<class S>(S) { pass<S>(part, factor, nullptr, fill, &sums); });
}

void CornerMap::add_through(int body, const Field& q, const AtSlaves& f, Field& sums) const {
    const Part& part = parts_[body];
    visit_spline(part.kernel, [&]<class S>(S) { pass<S>(part, Factor::Slope, &q, f, &sums); });
}

CornerMap::Slaves CornerMap::slaves_of(int body) const {
    const Part& part = parts_[body];
    const int n_groups = part.last_group - part.first_group;
    if (n_groups == 0)
        return {};
    return {groups_[part.first_group].begin,
            groups_[part.last_group - 1].end,
            (n_groups + group_block - 1) / group_block};
}

Vec3p CornerMap::second_moment(int body, int slave) const {
    const Part& part = parts_[body];
    const Vec3p& t = slave_local_[slave];
    return visit_spline(part.kernel,
                        [&]<class S>(S) {
                            const Vec3p exact =
                                S::n == 2 ? t * (1 - t) : Vec3p{} + S::second_moment;
                            const Vec3p least = Vec3p{} + least_moment;
                            return Vec3p(exact > least ? exact : least);
                        })
           * (part.cell_size * part.cell_size);
}

}  // namespace sim
