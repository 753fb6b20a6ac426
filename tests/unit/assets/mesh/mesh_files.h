// Small mesh files for the tests, written into a folder of their own.
#pragma once

#include "assets/base/vector_types.h"
#include "assets/mesh/import.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

/// A new empty folder, removed with all its files at the end.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const std::string& name, const std::string& content) const;

  private:
    std::filesystem::path path_;
};

/// A polygon mesh to be written in some format.
struct Polygons {
    std::vector<Vec3> positions;
    std::vector<std::vector<int>> faces;
};

/// The box from min to max of six quads facing outward, corner x + 2y + 4z.
Polygons box(const Vec3& min, const Vec3& max);

/// Both in one.
Polygons operator+(const Polygons& a, const Polygons& b);

/// All faces the other way round.
Polygons inside_out(Polygons polygons);

std::string as_obj(const Polygons& polygons);
std::string as_off(const Polygons& polygons);
std::string as_ply(const Polygons& polygons);
std::string as_stl(const Polygons& polygons);  // triangles of quads

/// Writes the obj into a temporary folder and imports it.
assets::ImportedMesh import_obj(const std::string& obj);

/// Whether one of the repairs contains the words.
bool tells(const std::vector<std::string>& repairs, const std::string& words);
