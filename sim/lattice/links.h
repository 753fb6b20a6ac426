// Which domains hang together: corners belong to material that meets, not to a place.
#pragma once

#include "sim/lattice/part_shape.h"

#include <map>
#include <vector>

namespace sim {

/// Tells whether the material of two cubes meets across what they share, a face, an edge or a corner.
class Links {
  public:
    Links(const CubeGrid& grid,
          const assets::Solid& solid,
          const std::vector<FilledCube>& cubes)
        : grid_(grid), solid_(solid), cubes_(cubes) {}

    /// Whether material of cubes p and q meets; their cells differ by at most one along each axis. Two parts of one cube
    /// do not. The regular samples decide where both sides have one at the same place, else fine cells do; parts as thick
    /// as a domain count as meeting up to a gap of a sample.
    bool meet(int p, int q);

  private:
    const FaceMask& mask(int p, int face);

    const CubeGrid& grid_;
    const assets::Solid& solid_;
    const std::vector<FilledCube>& cubes_;
    std::map<std::pair<int, int>, FaceMask> masks_;  // made so far, by (cube, face)
};

/// Corners shared by place are given to the domains whose material meets there [after N09 §3]: two domains
/// share a corner if a chain of domains around it leads from one to the other. Where several remain at one place they
/// follow each other, in the order of their lowest domain. Domains at such places get their part's blocks.
void separate_corners(Links& links,
                      const CubeGrid& grid,
                      const assets::Solid& solid,
                      const std::vector<FilledCube>& cubes,
                      Lattice& lattice);

}  // namespace sim
