// Off files (text; with or without colours, normals and texture coordinates).
#pragma once

#include "assets/mesh/polygon_soup.h"

#include <filesystem>

namespace assets {

/// The vertices and faces of an off file. Read here and not by assimp, which runs past the end of a
/// file cut short. Throws Error(Input) naming the file if it is none, or ends early.
PolygonSoup read_off(const std::filesystem::path& file);

}  // namespace assets
