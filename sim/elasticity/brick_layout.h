// Where a brick keeps the corners of its domains.
#pragma once

#include "sim/elasticity/brick.h"
#include "sim/lattice/lattice.h"

#include <array>
#include <vector>

namespace sim {

/// A box of cells.
struct CellRange {
    std::array<int, 3> low, high;  // inclusive
};

/// Around the cells of all domains.
CellRange cell_range(const Lattice& lattice);

/// Corners in rows along one axis, the others in turn: corner a + 1 of a domain follows its corner a = 0, 2, 4, 6. Rows hold
/// only corners that there are, so that a leaf takes no more than its own, and follow each other without gaps: where they are
/// equally long a batch goes on from one to the next.
struct BrickLayout {
    std::vector<int> corner;  // (#places) of the lattice
    std::vector<Batch> batches;
};

/// Along the axis that fills batches best: plates and rods have few domains along the others.
///
/// Requires that no two of the domains' corners are in the same cell of the lattice.
BrickLayout best_brick_layout(const Lattice& lattice, const std::vector<int>& domains);

}  // namespace sim
