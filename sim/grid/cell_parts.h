// Cells of a body's grid, cut into parts that its domains connect.
#pragma once

#include "sim/grid/corner_map.h"

#include <array>
#include <vector>

namespace sim {

/// Corners of one body that lie in a cell are one part of it where domains connect them within the cell. A node has as many
/// copies as there are sets of parts around it that domains connect there: so two legs of a body that stand in the same cells do
/// not move each other (virtual nodes, as [MBF04] has them for cuts). "Cell" stands for where stencils have their lowest node.
struct CellParts {
    std::vector<int> part_of_corner;  // (#corners of the body)
    // (#parts) node of the stencil, in order of cells, x fastest.
    std::vector<std::array<int, 3>> lowest;
    // (#parts × n³) the nodes of each part's stencil: the same number is the same one.
    std::vector<int> copies;
    int n_copies = 0;

    /// Node of the stencil of a corner of the body, in cells.
    Vec3p lowest_of(int corner) const {
        const auto& [x, y, z] = lowest[part_of_corner[corner]];
        return Vec3p{double(x), double(y), double(z), 0};
    }
};

/// Of corners [begin, end) of `corners` (#C), connected by body.domains, for stencils of n nodes along each axis whose lowest is
/// floor(x/h - shift). Throws FlownApart.
CellParts cut_cells(const Field& corners,
                    const CornerMap::BodyRange& body,
                    int n,
                    double shift);

}  // namespace sim
