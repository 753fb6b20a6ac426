#include "tests/unit/assets/mesh/mesh_files.h"

#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
    static std::atomic<int> count{0};
    path_ = fs::temp_directory_path() / fmt::format("supple_mesh_{}_{}", getpid(), count++);
    fs::create_directory(path_);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

fs::path TemporaryFolder::write(const std::string& name, const std::string& content) const {
    const fs::path file = path_ / name;
    std::ofstream(file, std::ios::binary) << content;
    return file;
}

Polygons box(const Vec3& min, const Vec3& max) {
    Polygons box;
    for (int k = 0; k < 8; ++k)
        box.positions.emplace_back(
            (k & 1 ? max : min).x(), (k & 2 ? max : min).y(), (k & 4 ? max : min).z());
    box.faces = {
        {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    return box;
}

Polygons operator+(const Polygons& a, const Polygons& b) {
    Polygons both = a;
    both.positions.insert(both.positions.end(), b.positions.begin(), b.positions.end());
    for (std::vector<int> face : b.faces) {
        for (int& v : face)
            v += static_cast<int>(a.positions.size());
        both.faces.push_back(face);
    }
    return both;
}

Polygons inside_out(Polygons polygons) {
    for (std::vector<int>& face : polygons.faces)
        std::reverse(face.begin(), face.end());
    return polygons;
}

namespace {

std::string lines_of(const std::vector<Vec3>& positions, const std::string& prefix) {
    std::string text;
    for (const Vec3& p : positions)
        text += fmt::format("{}{} {} {}\n", prefix, p.x(), p.y(), p.z());
    return text;
}

std::string counted_lines_of(const std::vector<std::vector<int>>& faces) {
    std::string text;
    for (const std::vector<int>& face : faces)
        text += fmt::format("{} {}\n", face.size(), fmt::join(face, " "));
    return text;
}

}  // namespace

std::string as_obj(const Polygons& polygons) {
    std::string text = lines_of(polygons.positions, "v ");
    for (std::vector<int> face : polygons.faces) {
        for (int& v : face)
            ++v;
        text += fmt::format("f {}\n", fmt::join(face, " "));
    }
    return text;
}

std::string as_off(const Polygons& polygons) {
    return fmt::format("OFF\n{} {} 0\n", polygons.positions.size(), polygons.faces.size())
           + lines_of(polygons.positions, "") + counted_lines_of(polygons.faces);
}

std::string as_ply(const Polygons& polygons) {
    return fmt::format(
               "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
               "property float z\nelement face {}\nproperty list uchar int "
               "vertex_indices\nend_header\n",
               polygons.positions.size(),
               polygons.faces.size())
           + lines_of(polygons.positions, "") + counted_lines_of(polygons.faces);
}

std::string as_stl(const Polygons& polygons) {
    std::string text = "solid crate\n";
    for (const std::vector<int>& face : polygons.faces) {
        for (size_t k = 1; k + 1 < face.size(); ++k) {
            const std::vector<Vec3> corners = {polygons.positions[face[0]],
                                               polygons.positions[face[k]],
                                               polygons.positions[face[k + 1]]};
            text += "facet normal 0 0 0\nouter loop\n" + lines_of(corners, "vertex ")
                    + "endloop\nendfacet\n";
        }
    }
    return text + "endsolid crate\n";
}

assets::ImportedMesh import_obj(const std::string& obj) {
    const TemporaryFolder folder;
    return assets::import_mesh(folder.write("mesh.obj", obj));
}

bool tells(const std::vector<std::string>& repairs, const std::string& words) {
    return std::any_of(repairs.begin(), repairs.end(), [&](const std::string& repair) {
        return repair.find(words) != std::string::npos;
    });
}
