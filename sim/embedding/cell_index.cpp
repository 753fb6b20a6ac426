#include "sim/embedding/cell_index.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sim {

CellIndex::CellIndex(const Lattice& lattice) : lattice_(lattice) {
    assets::check(lattice.n_domains() > 0, "a lattice has domains");
    for (const std::array<int, 3>& cell : lattice.cell)
        for (int axis = 0; axis < 3; ++axis)
            n_[axis] = std::max(n_[axis], cell[axis] + 1);
    row_begin_.assign(static_cast<std::size_t>(n_[1]) * n_[2] + 1, 0);
    for (const auto& [x, y, z] : lattice.cell)
        ++row_begin_[static_cast<std::size_t>(z) * n_[1] + y + 1];
    for (std::size_t row = 1; row < row_begin_.size(); ++row)
        row_begin_[row] += row_begin_[row - 1];
}

int CellIndex::find(const std::array<int, 3>& cell) const {
    for (int axis = 0; axis < 3; ++axis)
        if (cell[axis] < 0 || cell[axis] >= n_[axis])
            return -1;
    const std::size_t row = static_cast<std::size_t>(cell[2]) * n_[1] + cell[1];
    const auto begin = lattice_.cell.begin() + row_begin_[row];
    const auto end = lattice_.cell.begin() + row_begin_[row + 1];
    const auto found =
        std::lower_bound(begin, end, cell[0], [](const std::array<int, 3>& domain, int x) {
            return domain[0] < x;
        });
    return found != end && (*found)[0] == cell[0]
               ? static_cast<int>(found - lattice_.cell.begin())
               : -1;
}

int CellIndex::nearest(const Vec3& point) const {
    std::array<int, 3> center;
    for (int axis = 0; axis < 3; ++axis)
        center[axis] =
            static_cast<int>(std::clamp(std::floor(point[axis]), 0.0, n_[axis] - 1.0));
    Nearest nearest;
    const int last_ring = std::max({n_[0], n_[1], n_[2]});
    for (int ring = 0; ring <= last_ring; ++ring) {
        // Cells of this ring are at least ring - 1 edges away.
        if (nearest.domain >= 0 && (ring - 1.0) * (ring - 1.0) > nearest.squared)
            break;
        visit_ring(center, ring, point, nearest);
        if (nearest.domain >= 0 && nearest.squared == 0)
            break;
    }
    return nearest.domain;
}

int CellIndex::nearest_part(const Vec3& point) const {
    const int first = nearest(point);
    if (lattice_.part[first] < 0)
        return first;
    // Parts of the cube itself mostly have it; else the material belongs to a part that only reaches a neighbour.
    constexpr double block = 1.0 / PartBlocks::per_edge;
    const std::array<int, 3> cell = lattice_.cell[first];
    Nearest best = nearest_of_cell(cell, point);
    if (best.squared <= block * block)
        return best.domain;
    for (int n = 0; n < 27; ++n) {
        const std::array<int, 3> near = {
            cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
        const Nearest other = nearest_of_cell(near, point);
        if (other.domain >= 0 && other.squared < best.squared)
            best = other;
    }
    return best.domain;
}

CellIndex::Nearest CellIndex::nearest_of_cell(const std::array<int, 3>& cell,
                                              const Vec3& point) const {
    Nearest best;
    for (int p = find(cell); p >= 0 && p < lattice_.n_domains() && lattice_.cell[p] == cell
                             && lattice_.part[p] >= 0;
         ++p) {
        const double squared = squared_distance(lattice_, p, point);
        if (best.domain < 0 || squared < best.squared)
            best = {p, squared};
    }
    return best;
}

void CellIndex::visit_ring(const std::array<int, 3>& center,
                           int ring,
                           const Vec3& point,
                           Nearest& nearest) const {
    const auto low = [&](int axis) { return std::max(center[axis] - ring, 0); };
    const auto high = [&](int axis) { return std::min(center[axis] + ring, n_[axis] - 1); };
    for (int z = low(2); z <= high(2); ++z)
        for (int y = low(1); y <= high(1); ++y) {
            const bool on_face =
                std::abs(z - center[2]) == ring || std::abs(y - center[1]) == ring;
            if (on_face) {
                for (int x = low(0); x <= high(0); ++x)
                    visit({x, y, z}, point, nearest);
            } else {
                visit({center[0] - ring, y, z}, point, nearest);
                visit({center[0] + ring, y, z}, point, nearest);
            }
        }
}

void CellIndex::visit(const std::array<int, 3>& cell,
                      const Vec3& point,
                      Nearest& nearest) const {
    const int domain = find(cell);
    if (domain < 0)
        return;
    const Vec3 low(cell[0], cell[1], cell[2]);
    const Vec3 beyond = (low - point).cwiseMax(point - low - Vec3::Ones()).cwiseMax(0.0);
    const double squared = beyond.squaredNorm();
    if (nearest.domain < 0 || squared < nearest.squared
        || (squared == nearest.squared && domain < nearest.domain))
        nearest = {domain, squared};
}

}  // namespace sim
