// Scene files through assimp.
#pragma once

#include "assets/mesh/polygon_soup.h"

#include <filesystem>
#include <string>
#include <vector>

namespace assets {

/// The faces of every mesh of the file, moved by their nodes, in the axes of the file; in metres
/// where the format has a unit (fbx, dae), else its numbers as they are. Groups are named by
/// materials, or where these have no name by meshes or nodes. What was converted is added to
/// `notes`. Throws Error(Input) naming the file and, where its format cannot be read, some that
/// can.
PolygonSoup read_scene(const std::filesystem::path& file, std::vector<std::string>* notes);

}  // namespace assets
