// Which domain holds a point of rest space.
#pragma once

#include "sim/lattice/lattice.h"

#include <array>
#include <vector>

namespace sim {

/// Finds domains by their cells, row by row along x: memory stays that of the rows, not of the bounding box.
class CellIndex {
  public:
    explicit CellIndex(const Lattice& lattice);

    /// The domain of a cell, the first of several, or -1 where the body does not fill it.
    int find(const std::array<int, 3>& cell) const;

    /// The domain nearest to a point in lattice units, (X - origin) / s; the lowest of several at the same distance.
    int nearest(const Vec3& point) const;

    /// The same where the nearest domain has no neighbour that it is not connected to; else, of the domains around, the
    /// one whose material is nearest.
    int nearest_part(const Vec3& point) const;

  private:
    struct Nearest {
        int domain = -1;
        double squared = 0;  // [domain edges²]
    };

    Nearest nearest_of_cell(const std::array<int, 3>& cell, const Vec3& point) const;
    void visit_ring(const std::array<int, 3>& center,
                    int ring,
                    const Vec3& point,
                    Nearest& nearest) const;
    void visit(const std::array<int, 3>& cell, const Vec3& point, Nearest& nearest) const;

    const Lattice& lattice_;
    std::array<int, 3> n_{0, 0, 0};  // cells along each axis
    std::vector<int> row_begin_;     // (n_y n_z + 1) first domain of each row
};

}  // namespace sim
