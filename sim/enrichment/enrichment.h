// Which domains move on corners of their own. [Z18 §5.1]
#pragma once

#include "sim/base/field.h"
#include "sim/lattice/lattice.h"

#include <array>
#include <vector>

namespace sim {

/// Domains one of whose six face neighbours belongs to another region. [Z18 Algorithm 1]
std::vector<int> boundary_domains(const Lattice& lattice);

/// Enriches the domains of one body by the criteria of EnrichmentCriteria, together. A domain is enriched
///
///   interface    where its centre lies in a background cell that holds the centre of a boundary domain [Z18 Algorithm 2]
///   thin         where its part is spanned by fewer than three cells, at rest: the grid cannot bend it (ours)
///   mixed_cell   where its centre lies in a cell with centres of two regions: scattered materials, whose domains need
///                not be neighbours (the limit named in [Z18 §7])
///   strain       where its smallest principal stretch, or the smallest over the largest, falls under a bound (the idea
///                of [ZZL17]; the bounds are ours)
///
/// and remains so until it has left by a margin: a quarter of a cell, or a tenth of stretch. So corners do not flicker.
class Enrichment {
  public:
    /// `cell_size`: of the background grid [m].
    Enrichment(const Lattice& lattice, const EnrichmentCriteria& criteria, double cell_size);

    /// Decides anew, after the domains enriched so far; the corners of enriched domains become free.
    /// `corners` (#C) [m], `free` (#C) is only ever set to 1. Throws FlownApart.
    void update(const Lattice& lattice, const Vec3p* corners, char* free);

    const std::vector<char>& enriched() const { return enriched_; }  // (#D)

    /// What a checkpoint has kept of enriched().
    void restore(std::vector<char> enriched) { enriched_ = std::move(enriched); }

  private:
    void find_centres(const Lattice& lattice, const Vec3p* corners);
    void mark_cells(const Lattice& lattice);

    EnrichmentCriteria criteria_;
    double cell_size_ = 0;
    std::vector<char> is_boundary_, is_thin_, enriched_;  // (#D)

    // Of the cells in the box [low_, low_ + size_), x fastest: what they hold, and what they would hold of centres within
    // the margin around them.
    struct Cell {
        int region = -1, near_region = -1;  // -1: none met, -2: several
        bool boundary = false, near_boundary = false;
    };

    int index_of(const Vec3p& cell) const;

    std::vector<int> marking_;  // domains that decide about the cells around them
    Vec3p low_{};
    std::array<int, 3> step_{};    // from a cell to the next along x, y and z
    std::vector<Cell> cells_;      // without marks between steps
    std::vector<bool> is_marked_;  // (#cells) small enough to be asked for every domain
    std::vector<int> marked_;      // of them
    std::vector<Vec3p> centres_;   // (#D) in cells
};

}  // namespace sim
