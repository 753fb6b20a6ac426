// Cubes that a body hardly touches.
#pragma once

#include "sim/lattice/voxels.h"

#include <vector>

namespace sim {

/// Gives what fills a cube by less than a twentieth to the neighbour that it lies on, face to face, and takes the cube away;
/// points there are carried by the neighbour's map, continued beyond it.
///
/// A domain's one point is in the middle of its cube, far from the little that fills it at one side. So its outer corners, which
/// no other domain holds, are light and loose: where the surface moves they swing like the end of a whip, many times as
/// fast as the body, and where it is pressed along itself the domain turns inside out long before the body does.
///
/// Regions and volume are kept: a cube stays where the neighbour is mostly of another region. It also stays where cubes are
/// sampled finely (thin parts of the body), where there are only such small ones beside it, and where one of those lies on it.
/// `cubes` sorted, as fill_cubes() gives them.
void join_slivers(std::vector<FilledCube>& cubes);

}  // namespace sim
