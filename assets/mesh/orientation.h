// Which way the triangles of a surface face.
#pragma once

#include "assets/mesh/triangle_mesh.h"

#include <string>
#include <vector>

namespace assets {

/// Turns triangles so that neighbours agree and every part faces outward. A part is what hangs
/// together over edges of exactly two triangles. "Outward" is the side that makes the part's volume
/// positive once its holes are closed by fans; where those fans are large beside the part (a sheet,
/// a bowl) there is no inside, and the side that most of its area faces in the file is kept. Parts
/// inside others face outward too: they are solids in a solid, not cavities. One-sided parts
/// (Möbius strips) are told and stay inconsistent. Requires triangles with three distinct vertices.
void orient_outward(TriangleMesh& mesh, std::vector<std::string>* repairs);

}  // namespace assets
