// What the tests of the frame cache share: a folder that goes away, a small shot, folders as values.
#pragma once

#include "assets/frames/frame_cache.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

namespace tests {

/// A new empty folder, removed with all it holds at the end of the scope; in memory where the system has such a place,
/// as flushing to a disk would take most of the tests' time.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        const std::filesystem::path memory = "/dev/shm";
        const bool has_memory = ::access(memory.c_str(), W_OK) == 0;
        const auto place = has_memory ? memory : std::filesystem::temp_directory_path();
        std::string name = (place / "supple_test_XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr)
            throw std::runtime_error("cannot create a temporary folder");
        path_ = name;
    }

    ~TemporaryFolder() { std::filesystem::remove_all(path_); }

    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

inline std::string read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_file(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

/// Name -> bytes of every file under a folder.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    if (std::filesystem::exists(folder))
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
            if (entry.is_regular_file())
                files[std::filesystem::relative(entry.path(), folder).string()] =
                    read_file(entry.path());
    return files;
}

inline const assets::Fingerprint fingerprint{{"fps", "24"}, {"solver.dt", "0.001"}};

/// A fan of triangles around the first vertex.
inline assets::CachedSurface make_surface(const std::string& skin, int n_vertices) {
    assets::CachedSurface surface{"ball", skin, {}, {}, {}};
    for (int v = 0; v < n_vertices; ++v) {
        surface.rest_positions.emplace_back(std::cos(v), std::sin(v), 0.1f * v);
        surface.region_color.emplace_back(0.25f, 0.5f, 1.0f / (v + 1));
        if (v >= 2)
            surface.triangles.push_back({0, v - 1, v});
    }
    return surface;
}

/// The surface carried away and turned a little more in every frame; two attributes on it.
inline assets::SurfaceFrame move_surface(const assets::CachedSurface& surface, int number) {
    assets::SurfaceFrame moved;
    for (const Vec3f& X : surface.rest_positions) {
        moved.positions.push_back(X + Vec3f(std::sin(0.1f * number), 0, 0.01f * number));
        moved.normals.push_back((X + Vec3f(0, 0, 1 + number)).normalized());
        moved.attributes["stretch"].push_back(1 + 0.001f * number * X.x());
        moved.attributes["enriched"].push_back(X.y() > 0 ? 1.0f : 0.0f);
    }
    return moved;
}

/// A surface whose frames bring vertices and triangles of their own.
inline assets::CachedSurface make_varying(const std::string& skin) {
    assets::CachedSurface surface;
    surface.body = "snow";
    surface.skin = skin;
    surface.varying = true;
    return surface;
}

/// A fan of 4 + `number` vertices.
inline assets::SurfaceFrame vary_surface(int number) {
    const assets::CachedSurface fan = make_surface("", 4 + number);
    assets::SurfaceFrame varied = move_surface(fan, number);
    varied.triangles = fan.triangles;
    varied.region_color = fan.region_color;
    return varied;
}

inline assets::Frame make_frame(const std::vector<assets::CachedSurface>& surfaces,
                                int number) {
    assets::Frame frame{number, (number - 1) / 24.0, {}};
    for (const auto& surface : surfaces)
        frame.surfaces.push_back(surface.varying ? vary_surface(number)
                                                 : move_surface(surface, number));
    return frame;
}

inline std::vector<std::byte> make_state(int number) {
    std::vector<std::byte> state(4000);
    for (std::size_t i = 0; i < state.size(); ++i)
        state[i] = static_cast<std::byte>(i * i + static_cast<std::size_t>(number));
    return state;
}

}  // namespace tests
