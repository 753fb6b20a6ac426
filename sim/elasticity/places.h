// Where a brick keeps the corners of its domains.
#pragma once

#include "sim/lattice/lattice.h"

#include <array>
#include <vector>

namespace sim {

/// A box of cells.
struct Range {
    std::array<int, 3> low, high;  // inclusive
};

/// Around the cells of some domains, of all.
Range cell_range(const Lattice& lattice, const std::vector<int>& domains);
Range cell_range(const Lattice& lattice);

/// Places for the corners of a box of cells, along one axis after the other, the fastest first and the others in turn.
struct Places {
    std::array<int, 3> low, axes;  // the brick's axes, as axes of the lattice
    std::array<int, 3> step;       // to the next place along each of them
    int count = 0;

    Places(const Range& cells, int fastest)
        : low(cells.low), axes{fastest, (fastest + 1) % 3, (fastest + 2) % 3} {
        count = 1;
        for (int k = 0; k < 3; ++k) {
            step[k] = count;
            count *= cells.high[axes[k]] - cells.low[axes[k]] + 2;
        }
    }

    int of(const std::array<int, 3>& cell) const {
        int place = 0;
        for (int k = 0; k < 3; ++k)
            place += step[k] * (cell[axes[k]] - low[axes[k]]);
        return place;
    }

    int step_to_corner(int a) const {
        return step[0] * (a & 1) + step[1] * (a >> 1 & 1) + step[2] * (a >> 2);
    }

    /// Corner a of a domain as the lattice counts it.
    int lattice_corner(int a) const {
        return (a & 1) << axes[0] | (a >> 1 & 1) << axes[1] | (a >> 2) << axes[2];
    }
};

/// Along the axis that fills batches of lane_count best: plates and rods have few domains along the others.
Places best_places(const Lattice& lattice, const std::vector<int>& domains);

}  // namespace sim
