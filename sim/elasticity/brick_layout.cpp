#include "sim/elasticity/brick_layout.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace sim {

namespace {

CellRange cell_range(const Lattice& lattice, const std::vector<int>& domains) {
    CellRange range{lattice.cell[domains.front()], lattice.cell[domains.front()]};
    for (const int p : domains)
        for (int k = 0; k < 3; ++k) {
            range.low[k] = std::min(range.low[k], lattice.cell[p][k]);
            range.high[k] = std::max(range.high[k], lattice.cell[p][k]);
        }
    return range;
}

/// Numbers the corners of a box of cells along one axis after the other.
class Numbering {
  public:
    Numbering(const CellRange& cells, int fastest)
        : low_(cells.low), axes_{fastest, (fastest + 1) % 3, (fastest + 2) % 3} {
        int count = 1;
        for (int k = 0; k < 3; ++k) {
            step_[k] = count;
            count *= cells.high[axes_[k]] - cells.low[axes_[k]] + 2;
        }
    }

    int of(const std::array<int, 3>& cell) const {
        int number = 0;
        for (int k = 0; k < 3; ++k)
            number += step_[k] * (cell[axes_[k]] - low_[axes_[k]]);
        return number;
    }

    /// Corner a of a domain, counted along the axes of the numbering, as the lattice counts it.
    int lattice_corner(int a) const {
        return (a & 1) << axes_[0] | (a >> 1 & 1) << axes_[1] | (a >> 2) << axes_[2];
    }

  private:
    std::array<int, 3> low_, axes_, step_;
};

/// A domain's place in its brick.
struct Slot {
    std::array<int, 4> row;  // places of corners 0, 2, 4, 6
    int domain;
};

/// How far behind a batch's first domain one stands, the same in all rows; less than 0 where rows differ in it.
int lane_of(const Slot& slot, const Batch& batch) {
    const int lane = slot.row[0] - batch.row[0];
    for (int r = 0; r < 4; ++r)
        if (slot.row[r] - batch.row[r] != lane)
            return -1;
    return lane;
}

std::vector<Batch> batches_of(std::vector<Slot> slots) {
    std::sort(slots.begin(), slots.end(), [](const Slot& left, const Slot& right) {
        return left.row[0] < right.row[0];
    });
    std::vector<Batch> batches;
    for (const Slot& slot : slots) {
        int lane = batches.empty() ? -1 : lane_of(slot, batches.back());
        if (lane < 0 || lane >= lane_count) {
            Batch next{slot.row, {}, lane >= lane_count && lane < 2 * lane_count};
            next.domain.fill(-1);
            if (next.continues)
                for (int r = 0; r < 4; ++r)
                    next.row[r] = batches.back().row[r] + lane_count;
            lane = lane_of(slot, next);
            batches.push_back(next);
        }
        batches.back().domain[lane] = slot.domain;
    }
    return batches;
}

BrickLayout layout_along(const Lattice& lattice,
                         const std::vector<int>& domains,
                         const Numbering& numbering) {
    std::vector<std::pair<int, int>> corners;  // number, corner
    for (const int p : domains)
        for (const int c : lattice.corners[p])
            corners.emplace_back(numbering.of(lattice.corner_cell[c]), c);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());

    BrickLayout layout;
    for (const auto& [number, corner] : corners)
        layout.corner.push_back(corner);
    std::vector<Slot> slots;
    for (const int p : domains) {
        Slot slot{{}, p};
        for (int r = 0; r < 4; ++r) {
            const int c = lattice.corners[p][numbering.lattice_corner(2 * r)];
            const std::pair number_and_corner{numbering.of(lattice.corner_cell[c]), c};
            slot.row[r] = static_cast<int>(
                std::lower_bound(corners.begin(), corners.end(), number_and_corner)
                - corners.begin());
        }
        slots.push_back(slot);
    }
    layout.batches = batches_of(std::move(slots));
    return layout;
}

}  // namespace

CellRange cell_range(const Lattice& lattice) {
    std::vector<int> all(lattice.n_domains());
    std::iota(all.begin(), all.end(), 0);
    return cell_range(lattice, all);
}

BrickLayout best_brick_layout(const Lattice& lattice, const std::vector<int>& domains) {
    const CellRange range = cell_range(lattice, domains);
    BrickLayout best = layout_along(lattice, domains, Numbering(range, 0));
    for (const int axis : {1, 2}) {
        BrickLayout layout = layout_along(lattice, domains, Numbering(range, axis));
        if (layout.batches.size() < best.batches.size())
            best = std::move(layout);
    }
    return best;
}

}  // namespace sim
