// Small mesh files for tests, removed with their object.
#pragma once

#include "assets/generators/solid.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <utility>

/// An OBJ file in the system's folder for temporary files, its triangles under their groups as materials.
class ObjFile {
  public:
    ObjFile(const std::string& name, const assets::TriangleMesh& mesh)
        : path_(std::filesystem::temp_directory_path()
                / (name + std::to_string(getpid()) + ".obj")) {
        std::ofstream file(path_);
        file.precision(17);
        for (const Vec3& x : mesh.positions)
            file << "v " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
        int group = -1;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            if (!mesh.groups.empty() && mesh.triangle_group[t] != group)
                file << "usemtl " << mesh.groups[group = mesh.triangle_group[t]] << '\n';
            const auto& [a, b, c] = mesh.triangles[t];
            file << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
        }
    }

    ObjFile(const ObjFile&) = delete;
    ObjFile& operator=(const ObjFile&) = delete;

    ~ObjFile() { std::filesystem::remove(path_); }

    const std::filesystem::path& path() const { return path_; }

    assets::Source source() const { return {assets::MeshFile{path_}, {}}; }

  private:
    std::filesystem::path path_;
};
