// Ply files, text and binary.
#pragma once

#include "assets/mesh/polygon_soup.h"

#include <filesystem>

namespace assets {

/// The vertices and faces of a ply file; its other elements and properties are passed over. Read
/// here and not by assimp, which believes the counts of the header: it makes up what a file cut
/// short lacks, or reads on past its end. Throws Error(Input) naming the file if it is none, or
/// ends early.
PolygonSoup read_ply(const std::filesystem::path& file);

}  // namespace assets
