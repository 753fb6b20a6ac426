#include "sim/grid/corner_map.h"

#include "assets/base/error.h"
#include "sim/base/parallel.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int cell_chunk = 1024;
constexpr int node_chunk = 4096;
constexpr double most_cells = 1 << 28;

/// Trilinear weights of the local coordinates t in [0,1]³, node a at (a & 1, a >> 1 & 1, a >> 2 & 1).
std::array<double, 8> trilinear_weights(const Vec3p& t) {
    const double x[2] = {1 - t[0], t[0]}, y[2] = {1 - t[1], t[1]}, z[2] = {1 - t[2], t[2]};
    std::array<double, 8> w;
    for (int a = 0; a < 8; ++a)
        w[a] = x[a & 1] * (y[a >> 1 & 1] * z[a >> 2]);
    return w;
}

Vec3p floor_of(const Vec3p& v) {
    return Vec3p{std::floor(v[0]), std::floor(v[1]), std::floor(v[2]), 0};
}

struct CellBox {
    Vec3p low{}, high{};  // integer cell coordinates, inclusive

    std::array<int, 3> size() const {
        return {
            int(high[0] - low[0]) + 1, int(high[1] - low[1]) + 1, int(high[2] - low[2]) + 1};
    }
};

}  // namespace

void CornerMap::rebuild(const Field& corners,
                        const std::vector<char>& free,
                        const std::vector<BodyRange>& bodies) {
    dof_of_corner_.assign(corners.size(), -1);
    free_corner_.clear();
    dof_body_.clear();
    dof_position_.clear();
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (int c = bodies[b].begin; c < bodies[b].end; ++c)
            if (free[c]) {
                dof_of_corner_[c] = n_free();
                free_corner_.push_back(c);
                dof_body_.push_back(static_cast<int>(b));
                dof_position_.push_back(corners[c]);
            }
    n_nodes_ = 0;
    cells_.clear();
    slave_corner_.clear();
    slave_weights_.clear();
    node_sources_.clear();
    for (std::size_t b = 0; b < bodies.size(); ++b)
        rebuild_body(corners, bodies[b], static_cast<int>(b));
    cell_sums_.resize(8 * cells_.size());
}

void CornerMap::rebuild_body(const Field& corners, const BodyRange& body, int index) {
    // The box of cells that holds all slaved corners.
    const double inverse_size = 1 / body.cell_size;
    CellBox box;
    Vec3p sum{};  // not finite where a corner is not: comparisons alone would pass over it
    bool any = false;
    slave_order_.clear();
    for (int c = body.begin; c < body.end; ++c) {
        if (dof_of_corner_[c] >= 0)
            continue;
        const Vec3p cell = floor_of(corners[c] * inverse_size);
        if (!any)
            box.low = box.high = cell;
        any = true;
        box.low = cell < box.low ? cell : box.low;
        box.high = cell > box.high ? cell : box.high;
        sum += cell;
        slave_order_.push_back(c);
    }
    if (!any)
        return;
    const Vec3p extent = box.high - box.low + 1.0;
    if (!(extent[0] * extent[1] * extent[2] < most_cells)
        || !std::isfinite(sum[0] + sum[1] + sum[2]))
        throw assets::Error(
            assets::ErrorKind::Diverged,
            "a body spreads over more background cells than can be held; it has flown apart");

    // Counting sort of the slaved corners by cell.
    const std::array<int, 3> n = box.size();
    const int n_cells = n[0] * n[1] * n[2];
    cell_start_.assign(n_cells + 1, 0);
    cell_of_slave_.resize(slave_order_.size());
    for (std::size_t k = 0; k < slave_order_.size(); ++k) {
        const Vec3p local = floor_of(corners[slave_order_[k]] * inverse_size) - box.low;
        const int cell = int(local[0]) + n[0] * (int(local[1]) + n[1] * int(local[2]));
        cell_of_slave_[k] = cell;
        ++cell_start_[cell + 1];
    }
    for (int cell = 0; cell < n_cells; ++cell)
        cell_start_[cell + 1] += cell_start_[cell];

    // Occupied cells in order, each with its range of slaves.
    const int first_slave = static_cast<int>(slave_corner_.size());
    const int first_new_cell = static_cast<int>(cells_.size());
    std::vector<int>& base =
        node_of_;  // dense coordinates of each occupied cell, read by number_nodes
    base.clear();
    for (int cell = 0; cell < n_cells; ++cell)
        if (cell_start_[cell + 1] > cell_start_[cell]) {
            cells_.push_back(
                {{}, first_slave + cell_start_[cell], first_slave + cell_start_[cell + 1]});
            base.push_back(cell);
        }
    slave_corner_.resize(first_slave + slave_order_.size());
    slave_weights_.resize(slave_corner_.size());
    for (std::size_t k = 0; k < slave_order_.size(); ++k) {
        const int slave = first_slave + cell_start_[cell_of_slave_[k]]++;
        const Vec3p scaled = corners[slave_order_[k]] * inverse_size;
        slave_corner_[slave] = slave_order_[k];
        slave_weights_[slave] = trilinear_weights(scaled - floor_of(scaled));
    }
    number_nodes(n, first_new_cell, base);

    dof_body_.resize(n_dofs(), index);
    dof_position_.resize(n_dofs());
    for (std::size_t k = 0; k < base.size(); ++k) {
        const Vec3p cell = box.low
                           + Vec3p{double(base[k] % n[0]),
                                   double(base[k] / n[0] % n[1]),
                                   double(base[k] / (n[0] * n[1])),
                                   0};
        for (int a = 0; a < 8; ++a)
            dof_position_[cells_[first_new_cell + k].nodes[a]] =
                (cell + Vec3p{double(a & 1), double(a >> 1 & 1), double(a >> 2), 0})
                * body.cell_size;
    }
}

void CornerMap::number_nodes(const std::array<int, 3>& n_cells_per_axis,
                             int first_new_cell,
                             const std::vector<int>& base) {
    const int nx = n_cells_per_axis[0], ny = n_cells_per_axis[1], nz = n_cells_per_axis[2];
    const int stride_y = nx + 1, stride_z = (nx + 1) * (ny + 1);
    std::vector<int>& node_of = cell_start_;
    node_of.assign(static_cast<std::size_t>(stride_z) * (nz + 1), -1);
    for (std::size_t k = 0; k < base.size(); ++k) {
        const int cell = first_new_cell + static_cast<int>(k);
        const int i = base[k] % nx, j = base[k] / nx % ny, l = base[k] / (nx * ny);
        for (int a = 0; a < 8; ++a) {
            int& node = node_of[i + (a & 1) + stride_y * (j + (a >> 1 & 1))
                                + stride_z * (l + (a >> 2))];
            if (node < 0) {
                node = n_nodes_++;
                node_sources_.push_back({-1, -1, -1, -1, -1, -1, -1, -1});
            }
            cells_[cell].nodes[a] = n_free() + node;
            node_sources_[node][a] = 8 * cell + a;
        }
    }
}

void CornerMap::apply(const Field& q, Field& u) const {
    for (int k = 0; k < n_free(); ++k)
        u[free_corner_[k]] = q[k];
    for_chunks(static_cast<int>(cells_.size()), cell_chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            const Cell& cell = cells_[k];
            Vec3p v[8];
            for (int a = 0; a < 8; ++a)
                v[a] = q[cell.nodes[a]];
            for (int s = cell.begin; s < cell.end; ++s) {
                const auto& w = slave_weights_[s];
                u[slave_corner_[s]] =
                    ((w[0] * v[0] + w[1] * v[1]) + (w[2] * v[2] + w[3] * v[3]))
                    + ((w[4] * v[4] + w[5] * v[5]) + (w[6] * v[6] + w[7] * v[7]));
            }
        }
    });
}

template <bool squared>
void CornerMap::gather(const Field& f, Field& q) const {
    for (int k = 0; k < n_free(); ++k)
        q[k] = f[free_corner_[k]];
    // Each cell sums what its corners give to its eight nodes.
    for_chunks(static_cast<int>(cells_.size()), cell_chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            Vec3p sum[8] = {};
            for (int s = cells_[k].begin; s < cells_[k].end; ++s) {
                const Vec3p value = f[slave_corner_[s]];
#pragma GCC unroll 8  // the eight sums live in registers
                for (int a = 0; a < 8; ++a) {
                    const double w = slave_weights_[s][a];
                    sum[a] += (squared ? w * w : w) * value;
                }
            }
            for (int a = 0; a < 8; ++a)
                cell_sums_[8 * k + a] = sum[a];
        }
    });
    // Each node sums its cells.
    for_chunks(n_nodes_, node_chunk, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            Vec3p sum{};
            for (const int source : node_sources_[i])
                if (source >= 0)
                    sum += cell_sums_[source];
            q[n_free() + i] = sum;
        }
    });
}

void CornerMap::apply_transposed(const Field& f, Field& q) const {
    gather<false>(f, q);
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

void CornerMap::apply_squared_transposed(const Field& k, Field& d) const {
    gather<true>(k, d);
}

}  // namespace sim
