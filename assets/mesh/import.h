// Meshes of files (obj, ply, stl, gltf, glb, fbx, 3ds, ...) through assimp.
#pragma once

#include "assets/mesh/triangle_mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace assets {

struct ImportedMesh {
    TriangleMesh mesh;
    std::vector<std::string> repairs;  // what was mended or is amiss, one sentence each
    bool closed = false;  // every edge has exactly two triangles, oppositely directed
};

/// Reads a mesh: polygons triangulated, equal positions welded, degenerate and doubled triangles dropped,
/// orientation made consistent and outward, node transforms applied, material names kept as groups.
/// Every repair is stated. Throws Error(Input) naming the file where it is missing, unreadable, empty or has
/// coordinates that are not finite.
ImportedMesh import_mesh(const std::filesystem::path& file);

}  // namespace assets
