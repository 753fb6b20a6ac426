#include "assets/mesh/polygon_soup.h"

#include "assets/base/error.h"
#include "assets/mesh/polygon.h"
#include "assets/mesh/text.h"

#include <algorithm>
#include <utility>

namespace assets {
namespace {

void require_finite(const std::vector<Vec3>& positions, const std::filesystem::path& file) {
    const auto bad = std::find_if(
        positions.begin(), positions.end(), [](const Vec3& x) { return !x.allFinite(); });
    if (bad != positions.end())
        throw Error(
            ErrorKind::Input,
            fmt::format(
                "mesh '{}': vertex {} has the coordinates ({}, {}, {}), which are not all "
                "finite numbers; mend it and export it again",
                file.string(),
                bad - positions.begin() + 1,
                bad->x(),
                bad->y(),
                bad->z()));
}

}  // namespace

TriangleMesh triangulated(PolygonSoup soup,
                          const std::filesystem::path& file,
                          std::vector<std::string>* notes) {
    require_finite(soup.positions, file);
    TriangleMesh mesh;
    size_t n_left_out = 0;
    std::vector<Vec3> polygon;
    for (size_t f = 0, begin = 0; f < soup.face_ends.size(); begin = soup.face_ends[f++]) {
        const auto face =
            std::span<const int>(soup.corners).subspan(begin, soup.face_ends[f] - begin);
        if (face.size() < 3) {
            ++n_left_out;
            continue;
        }
        polygon.clear();
        for (const int v : face) {
            if (v < 0 || v >= static_cast<int>(soup.positions.size()))
                throw_damaged(
                    file, fmt::format("face {} refers to a vertex that does not exist", f + 1));
            polygon.push_back(soup.positions[v]);
        }
        for (const auto& [a, b, c] : triangulate(polygon)) {
            mesh.triangles.push_back({face[a], face[b], face[c]});
            if (!soup.groups.empty())
                mesh.triangle_group.push_back(soup.face_group[f]);
        }
    }
    mesh.positions = std::move(soup.positions);
    mesh.groups = std::move(soup.groups);
    if (n_left_out > 0)
        notes->push_back(
            fmt::format("{} left out: only faces make a surface.",
                        counted(n_left_out, "line or point was", "lines or points were")));
    return mesh;
}

void throw_damaged(const std::filesystem::path& file, const std::string& fault) {
    throw Error(
        ErrorKind::Input,
        fmt::format(
            "mesh '{}' is damaged or incomplete: {}; export it again", file.string(), fault));
}

}  // namespace assets
