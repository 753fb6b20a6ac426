// How slaved corners are grouped and nodes are numbered.
#include "sim/base/cell_box.h"
#include "sim/base/floor.h"
#include "sim/grid/cell_parts.h"
#include "sim/grid/corner_map.h"
#include "sim/grid/kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

namespace sim {

namespace {

constexpr double widest_kernel = 4;  // nodes along an axis
constexpr int word = 64;             // bits

Vec3p in_all_axes(double v) {
    return Vec3p{v, v, v, 0};
}

}  // namespace

/// Lowest nodes of stencils: the integer coordinates of the first, and how many along each axis.
struct CornerMap::Box {
    Vec3p low{};
    std::array<int, 3> n{0, 0, 0};

    int count() const { return n[0] * n[1] * n[2]; }
};

void CornerMap::rebuild(const Field& corners,
                        const std::vector<char>& free,
                        const std::vector<BodyRange>& bodies) {
    // Free and slaved corners take turns in no order that a processor could guess: no branches.
    dof_of_corner_.resize(corners.size());
    slave_of_corner_.resize(corners.size());
    free_corner_.resize(corners.size());
    dof_body_.resize(corners.size());
    int n = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (int c = bodies[b].begin; c < bodies[b].end; ++c) {
            dof_of_corner_[c] = free[c] ? n : -1;
            free_corner_[n] = c;
            dof_body_[n] = static_cast<int>(b);
            n += free[c] ? 1 : 0;
        }
    free_corner_.resize(n);
    dof_body_.resize(n);
    dof_position_.resize(n);
    for (int k = 0; k < n; ++k)
        dof_position_[k] = corners[free_corner_[k]];
    n_nodes_ = 0;
    parts_.clear();
    groups_.clear();
    group_nodes_.clear();
    slave_corner_.clear();
    slave_local_.clear();
    group_of_slave_.clear();
    trilinear_weights_.clear();
    for (std::size_t b = 0; b < bodies.size(); ++b)
        rebuild_body(corners, bodies[b], static_cast<int>(b));
}

void CornerMap::place(const Field& corners, const Field& nodes) {
    for (int k = 0; k < n_free(); ++k)
        dof_position_[k] = corners[free_corner_[k]];
    std::copy(nodes.begin(), nodes.end(), dof_position_.begin() + n_free());
}

void CornerMap::rebuild_body(const Field& corners, const BodyRange& body, int index) {
    Part part;
    part.kernel = body.kernel;
    part.cell_size = body.cell_size;
    const auto first_free = [&](int corner) {
        return static_cast<int>(
            std::lower_bound(free_corner_.begin(), free_corner_.end(), corner)
            - free_corner_.begin());
    };
    part.first_free = first_free(body.begin);
    part.last_free = first_free(body.end);
    part.first_group = part.last_group = static_cast<int>(groups_.size());
    part.first_node = part.last_node = n_nodes_;
    part.first_entry = group_nodes_.size();
    const auto [n, shift] = visit_spline(body.kernel, [](auto spline) {
        return std::pair(int(spline.n), double(spline.shift));
    });

    const Box box = box_of_slaves(corners, body, shift);
    if (!slave_order_.empty()) {
        std::optional<CellParts> parts;
        if (body.domains != nullptr)
            parts = cut_cells(corners, body, n, shift);
        const CellParts* cut = parts ? &*parts : nullptr;
        sort_slaves(corners, body, box, shift, cut);
        part.last_group = static_cast<int>(groups_.size());
        number_nodes(box, n, cut, part);
        part.last_node = n_nodes_;
        if (body.kernel == Kernel::Linear)
            keep_trilinear_weights(part);
        dof_body_.resize(n_dofs(), index);
    }
    parts_.push_back(part);
}

CornerMap::Box CornerMap::box_of_slaves(const Field& corners,
                                        const BodyRange& body,
                                        double shift) {
    const double inverse_size = 1 / body.cell_size;
    Box box;
    Vec3p high{},
        sum{};  // not finite where a corner is not: comparisons alone would pass over it
    slave_order_.resize(body.end - body.begin);
    int n_slaves = 0;
    for (int c = body.begin; c < body.end; ++c) {
        slave_order_[n_slaves] = c;
        n_slaves += dof_of_corner_[c] < 0 ? 1 : 0;
    }
    slave_order_.resize(n_slaves);
    for (const int c : slave_order_) {
        const Vec3p cell = floor_of(corners[c] * inverse_size - in_all_axes(shift));
        if (c == slave_order_.front())
            box.low = high = cell;
        box.low = cell < box.low ? cell : box.low;
        high = cell > high ? cell : high;
        sum += cell;
    }
    const Vec3p extent = high - box.low + 1.0;
    check_spread(extent + widest_kernel, sum);
    box.n = {int(extent[0]), int(extent[1]), int(extent[2])};
    return box;
}

void CornerMap::sort_slaves(const Field& corners,
                            const BodyRange& body,
                            const Box& box,
                            double shift,
                            const CellParts* parts) {
    // Counting sort by the lowest node of the stencil.
    const double inverse_size = 1 / body.cell_size;
    const std::size_t n_cells = parts != nullptr ? parts->lowest.size() : box.count();
    cell_slave_.resize(std::max(cell_slave_.size(), n_cells));
    occupied_.resize(std::max(occupied_.size(), n_cells / word + 1));
    cell_of_slave_.resize(slave_order_.size());
    for (std::size_t k = 0; k < slave_order_.size(); ++k) {
        const Vec3p& x = corners[slave_order_[k]];
        const Vec3p local = floor_of(x * inverse_size - in_all_axes(shift)) - box.low;
        const int cell =
            parts != nullptr
                ? parts->part_of_corner[slave_order_[k] - body.begin]
                : int(local[0]) + box.n[0] * (int(local[1]) + box.n[1] * int(local[2]));
        cell_of_slave_[k] = cell;
        ++cell_slave_[cell];
        occupied_[cell / word] |= std::uint64_t{1} << cell % word;
    }
    group_occupied_cells();
    slave_corner_.resize(slave_corner_.size() + slave_order_.size());
    slave_local_.resize(slave_corner_.size());
    for (std::size_t k = 0; k < slave_order_.size(); ++k) {
        const int slave = cell_slave_[cell_of_slave_[k]]++;
        const Vec3p scaled = corners[slave_order_[k]] * inverse_size;
        slave_corner_[slave] = slave_order_[k];
        slave_of_corner_[slave_order_[k]] = slave;
        // Where the product is not rounded before the difference (a fused instruction) a point on a node may come out a
        // rounding below it: its weights would be negative, and a node's mass the difference of such.
        const Vec3p least = in_all_axes(shift);
        const Vec3p lowest = parts != nullptr ? parts->lowest_of(slave_order_[k] - body.begin)
                                              : floor_of(scaled - least);
        const Vec3p local = scaled - lowest;
        slave_local_[slave] = local > least ? local : least;
    }
    for (const int cell : base_)
        cell_slave_[cell] = 0;
}

void CornerMap::group_occupied_cells() {
    // In their order, each with its range of slaves. Boxes around slender bodies are nearly empty.
    base_.clear();
    int begin = static_cast<int>(slave_corner_.size());
    for (std::size_t w = 0; w < occupied_.size(); ++w)
        for (; occupied_[w] != 0; occupied_[w] &= occupied_[w] - 1) {
            const int cell = static_cast<int>(w) * word + std::countr_zero(occupied_[w]);
            const int end = begin + std::exchange(cell_slave_[cell], begin);
            group_of_slave_.resize(end, static_cast<int>(groups_.size()));
            groups_.push_back({begin, end});
            base_.push_back(cell);
            begin = end;
        }
}

void CornerMap::keep_trilinear_weights(Part& part) {
    // Eight numbers are read faster than made of six, and bodies of domains ask for them many times a step.
    const int first = groups_[part.first_group].begin,
              last = static_cast<int>(slave_local_.size());
    part.first_trilinear = static_cast<int>(trilinear_weights_.size()) - first;
    trilinear_weights_.resize(part.first_trilinear + last);
    for (int s = first; s < last; ++s) {
        Vec3p w[2];
        Spline<1>::weights(slave_local_[s], w);
        std::array<double, 8>& products = trilinear_weights_[part.first_trilinear + s];
        for (int a = 0; a < 8; ++a)
            products[a] = w[a & 1][0] * (w[a >> 1 & 1][1] * w[a >> 2][2]);
    }
}

void CornerMap::number_nodes(const Box& box, int n, const CellParts* parts, Part& part) {
    const int per_group = n * n * n;
    const std::array<int, 3> size = {box.n[0] + n - 1, box.n[1] + n - 1, box.n[2] + n - 1};
    const std::size_t n_places = parts != nullptr
                                     ? parts->n_copies
                                     : static_cast<std::size_t>(size[0]) * size[1] * size[2];
    node_of_.resize(std::max(node_of_.size(), n_places), -1);
    placed_.clear();
    group_nodes_.resize(part.first_entry + base_.size() * per_group);
    int* group_node = group_nodes_.data() + part.first_entry;
    const std::array<int, 3> origin = {int(box.low[0]), int(box.low[1]), int(box.low[2])};
    for (const int base : base_) {
        std::array<int, 3> low = {
            base % box.n[0], base / box.n[0] % box.n[1], base / (box.n[0] * box.n[1])};
        for (int k = 0; k < 3 && parts != nullptr; ++k)
            low[k] = parts->lowest[base][k] - origin[k];
        const int* copy = parts != nullptr ? &parts->copies[base * per_group] : nullptr;
        for (int z = low[2]; z < low[2] + n; ++z)
            for (int y = low[1]; y < low[1] + n; ++y)
                for (int x = low[0]; x < low[0] + n; ++x) {
                    const int place =
                        copy != nullptr ? *copy++ : x + size[0] * (y + size[1] * z);
                    int& node = node_of_[place];
                    if (node < 0) {
                        node = n_nodes_++;
                        placed_.push_back(place);
                        const Vec3p from_lowest = {double(x), double(y), double(z), 0};
                        dof_position_.push_back((box.low + from_lowest) * part.cell_size);
                    }
                    *group_node++ = n_free() + node;
                }
    }
    for (const int place : placed_)
        node_of_[place] = -1;
}

}  // namespace sim
