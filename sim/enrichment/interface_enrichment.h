// Which domains move on corners of their own: those near an interface of materials. [Z18 §5.1]
#pragma once

#include "sim/base/field.h"
#include "sim/lattice/lattice.h"

#include <vector>

namespace sim {

/// Domains one of whose six face neighbours belongs to another region. [Z18 Algorithm 1]
std::vector<int> boundary_domains(const Lattice& lattice);

/// Enrichment of one body by the criterion "interface".
class InterfaceEnrichment {
  public:
    /// `cell_size`: of the background grid [m].
    InterfaceEnrichment(const Lattice& lattice, double cell_size);

    /// Marks the background cells that hold the centre of a boundary domain, and enriches every domain whose centre
    /// lies in a marked cell; their corners become free. [Z18 Algorithm 2]
    /// `corners` (#C) [m], `free` (#C) is only ever set to 1; enriched() tells the domains afterwards.
    void update(const Lattice& lattice, const Vec3p* corners, char* free);

    const std::vector<char>& enriched() const { return enriched_; }  // (#D)

  private:
    std::vector<int> boundary_;
    double cell_size_ = 0;
    std::vector<char> enriched_, marked_;
    std::vector<Vec3p> cell_of_domain_;
};

}  // namespace sim
