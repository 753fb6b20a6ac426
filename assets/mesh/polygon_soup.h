// What the readers of files hand on: polygons as the file has them, not yet checked.
#pragma once

#include "assets/base/vector_types.h"
#include "assets/mesh/triangle_mesh.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace assets {

struct PolygonSoup {
    std::vector<Vec3> positions;
    std::vector<int> corners;       // vertices of all faces, one after the other
    std::vector<size_t> face_ends;  // (#F) where each face's corners end
    std::vector<int> face_group;    // (#F) index into groups; empty where groups is
    std::vector<std::string> groups;
};

/// The polygons cut into triangles. Faces of one or two corners are left out and counted in
/// `notes`. Throws Error(Input) naming the file where coordinates are not finite, or a face's
/// vertex does not exist.
TriangleMesh triangulated(PolygonSoup soup,
                          const std::filesystem::path& file,
                          std::vector<std::string>* notes);

/// The error for a file that contradicts itself.
[[noreturn]] void throw_damaged(const std::filesystem::path& file, const std::string& fault);

}  // namespace assets
