// Where a body is too thin for its background grid.
#pragma once

#include "sim/lattice/lattice.h"

#include <vector>

namespace sim {

/// Domains of parts that no cube of 2 `depth` domains an edge fits into (#D). Where a cell of the grid is too large a share
/// of a part's thickness, the part cannot bend on its nodes: a trilinear cell shears where it should curve. With n cells
/// across, a beam is stiffer by about G / (E n²): a tenth for two, a twentieth for three.
///
/// Depths are counted in domains from the surface, across faces, edges and vertices. Near a cube that fits, up to half
/// a depth beyond it, a body is not thin: there curved surfaces lie, that cubes do not reach.
std::vector<char> thin_domains(const Lattice& lattice, double depth);

}  // namespace sim
