// G q and Gᵀ A: gradients at slaves.
#include "sim/base/lane_clones.h"
#include "sim/grid/corner_map.h"
#include "sim/grid/group_sums.h"
#include "sim/grid/kernel.h"

#include <algorithm>
#include <type_traits>

namespace sim {

namespace {

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

/// Of the slaves of a block; what they are is not kept.
template <class S>
struct Scratch {
    std::vector<Factors<S>> factors;
    std::vector<Gradient> values;
    Field means;

    Scratch& of(std::size_t n_slaves) {
        if (factors.size() < n_slaves) {
            factors.resize(n_slaves);
            values.resize(n_slaves);
            means.resize(n_slaves);
        }
        return *this;
    }
};

/// Σ_i v_i ∂w_i of each slave, summed along x, then y, then z; and Σ_i v_i w_i where it is asked for.
template <class S, bool with_mean>
SUPPLE_LANES void take_gradients(
    const Factors<S>* slaves, int n_slaves, const Vec3p* v, Gradient* gradients, Vec3p* means) {
    constexpr int n = S::n;
    for (int s = 0; s < n_slaves; ++s) {
        const Factors<S>& at = slaves[s];
        Gradient sum{};
        Vec3p mean{};
#pragma GCC unroll 4
        for (int c = 0; c < n; ++c) {
            Vec3p plane[3] = {};
#pragma GCC unroll 4
            for (int b = 0; b < n; ++b) {
                const Vec3p* of_row = v + n * (n * c + b);
                const Vec3p row = row_sum<n>(at.w, of_row), slope = row_sum<n>(at.d, of_row);
                plane[0] += at.w[b][1] * slope;
                plane[1] += at.d[b][1] * row;
                plane[2] += at.w[b][1] * row;
            }
            sum.column[0] += at.w[c][2] * plane[0];
            sum.column[1] += at.w[c][2] * plane[1];
            sum.column[2] += at.d[c][2] * plane[2];
            if constexpr (with_mean)
                mean += at.w[c][2] * plane[2];
        }
        gradients[s] = sum;
        if constexpr (with_mean)
            means[s] = mean;
    }
}

/// Σ_s A_s ∂w at the nodes of a stencil that all of its slaves have.
template <class S>
SUPPLE_LANES void sum_at_nodes(const Factors<S>* slaves,
                               const Gradient* A,
                               int n_slaves,
                               Vec3p* nodes) {
    constexpr int n = S::n;
    constexpr int rows = n == 4 ? 2 : n;  // summed at once, so that the sums live in registers
    for (int c = 0; c < n; ++c)
        for (int first = 0; first < n; first += rows, nodes += rows * n) {
            Vec3p sum[rows * n] = {};
            for (int s = 0; s < n_slaves; ++s) {
                const Factors<S>& at = slaves[s];
                const Vec3p x = at.w[c][2] * A[s].column[0], y = at.w[c][2] * A[s].column[1],
                            z = at.d[c][2] * A[s].column[2];
#pragma GCC unroll 4
                for (int b = 0; b < rows; ++b) {
                    const double w = at.w[first + b][1], d = at.d[first + b][1];
                    const Vec3p along = w * x, across = d * y + w * z;
#pragma GCC unroll 4
                    for (int a = 0; a < n; ++a) {
                        sum[n * b + a] += at.d[a][0] * along;
                        sum[n * b + a] += at.w[a][0] * across;
                    }
                }
            }
#pragma GCC unroll 9
            for (int a = 0; a < rows * n; ++a)
                nodes[a] = sum[a];
        }
}

}  // namespace

template <class S, class F>
void CornerMap::pass(
    const Part& part, Factor factor, const Field* q, const F& f, Field* sums) const {
    constexpr bool with_mean = std::is_same_v<F, AtMovedSlaves>;
    constexpr int n = S::n, per_group = n * n * n;
    const Group* groups = groups_.data() + part.first_group;
    const int* group_nodes = group_nodes_.data() + part.first_entry;

    // Blocks of a few groups after each other, so that all that belongs to their slaves stays in the cache.
    const auto pass_block = [&](int begin, int end, Shares* shares) {
        thread_local Scratch<S> scratch;
        const int first = groups[begin].begin, last = groups[end - 1].end;
        auto& [factors, values, means] = scratch.of(last - first);
        for (int s = first; s < last; ++s)
            factors[s - first] = {factor, slave_local_[s], part.cell_size};
        if (q != nullptr)
            for (int k = begin; k < end; ++k) {
                Vec3p v[per_group];
                for (int a = 0; a < per_group; ++a)
                    v[a] = (*q)[group_nodes[k * per_group + a]];
                const int s = groups[k].begin - first;
                take_gradients<S, with_mean>(
                    &factors[s], groups[k].end - groups[k].begin, v, &values[s], &means[s]);
            }
        const Slaves slaves{first, last, begin / group_block};
        if constexpr (with_mean)
            f(slaves, means.data(), values.data());
        else
            f(slaves, values.data());
        if (shares == nullptr)
            return;
        for (int k = begin; k < end; ++k) {
            const int s = groups[k].begin - first;
            Vec3p sum[per_group];
            sum_at_nodes<S>(&factors[s], &values[s], groups[k].end - groups[k].begin, sum);
            for (int a = 0; a < per_group; ++a)
                shares->at(group_nodes[k * per_group + a]) += sum[a];
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

void CornerMap::add_through(int body,
                            const Field& q,
                            const AtMovedSlaves& f,
                            Field& sums) const {
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

double CornerMap::second_moment(int body) const {
    const Part& part = parts_[body];
    return visit_spline(part.kernel, [&]<class S>(S) { return S::second_moment; })
           * (part.cell_size * part.cell_size);
}

}  // namespace sim
