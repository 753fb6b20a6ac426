#include "assets/mesh/import.h"

#include "assets/base/edit_distance.h"
#include "assets/base/error.h"
#include "assets/mesh/edges.h"
#include "assets/mesh/file_text.h"
#include "assets/mesh/off_file.h"
#include "assets/mesh/orientation.h"
#include "assets/mesh/ply_file.h"
#include "assets/mesh/polygon_soup.h"
#include "assets/mesh/repair.h"
#include "assets/mesh/scene_reader.h"
#include "assets/mesh/text.h"
#include "assets/mesh/weld.h"

#include <algorithm>
#include <system_error>

namespace assets {
namespace {

namespace fs = std::filesystem;

// " Did you mean 'x.obj'?" where the folder holds a file with nearly that name, else nothing.
std::string nearest_name(const fs::path& file) {
    const std::string wanted = file.filename().string();
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    std::error_code ignored;
    std::string nearest;
    int least = std::max(3, static_cast<int>(wanted.size()) / 3 + 1);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        const int distance = edit_distance(wanted, name);
        // Folders come in no order: the alphabet decides between names equally near.
        if (distance < least || (distance == least && !nearest.empty() && name < nearest)) {
            least = distance;
            nearest = name;
        }
    }
    return nearest.empty() ? ""
                           : fmt::format("; did you mean '{}'?", (folder / nearest).string());
}

void require_file(const fs::path& file) {
    std::error_code ignored;
    if (!fs::exists(file, ignored))
        throw Error(
            ErrorKind::Input,
            fmt::format("mesh '{}' does not exist{}", file.string(), nearest_name(file)));
    if (!fs::is_regular_file(file, ignored))
        throw Error(ErrorKind::Input,
                    fmt::format("mesh '{}' is not a file; give the path of the mesh itself",
                                file.string()));
}

PolygonSoup read_polygons(const fs::path& file, std::vector<std::string>* notes) {
    const std::string extension = extension_of(file);
    if (extension == ".ply")
        return read_ply(file);
    if (extension == ".off")
        return read_off(file);
    return read_scene(file, notes);
}

void require_surface(const TriangleMesh& mesh, const fs::path& file) {
    if (mesh.triangles.empty())
        throw Error(ErrorKind::Input,
                    fmt::format("mesh '{}' has no triangles with an area; export its faces",
                                file.string()));
}

// Says where the surface is not that of a solid. These faults stay.
void tell_faults(const TriangleMesh& mesh, std::vector<std::string>* repairs) {
    size_t n_overfull = 0;
    Vec3 first = Vec3::Zero();
    const std::vector<EdgeUse> uses = sorted_edge_uses(mesh.triangles);
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() > 2 && n_overfull++ == 0)
            first = (mesh.positions[edge[0].low] + mesh.positions[edge[0].high]) / 2;
    });
    if (n_overfull > 0)
        repairs->push_back(
            fmt::format("{} more than two triangles, the first at ({:.4g}, {:.4g}, {:.4g}) m.",
                        counted(n_overfull, "edge has", "edges have"),
                        first.x(),
                        first.y(),
                        first.z()));
    const int n_open = boundary_edge_count(mesh);
    if (n_open > 0)
        repairs->push_back(fmt::format("The surface is open: {} around {}.",
                                       counted(static_cast<size_t>(n_open), "boundary edge"),
                                       counted(find_holes(mesh).size(), "hole")));
}

}  // namespace

ImportedMesh import_mesh(const fs::path& file) {
    require_file(file);
    ImportedMesh imported;
    TriangleMesh& mesh = imported.mesh;
    mesh = triangulated(read_polygons(file, &imported.repairs), file, &imported.repairs);
    require_surface(mesh, file);

    const double diagonal = used_diagonal(mesh);
    if (diagonal <= 0)
        throw Error(ErrorKind::Input,
                    fmt::format("mesh '{}' has no size: all its vertices are at one place",
                                file.string()));
    const double tolerance = weld_fraction * diagonal;
    weld(mesh, tolerance, &imported.repairs);
    drop_degenerate(mesh, tolerance, &imported.repairs);
    drop_doubled(mesh, &imported.repairs);
    require_surface(mesh, file);
    orient_outward(mesh, &imported.repairs);
    tell_faults(mesh, &imported.repairs);
    imported.closed = is_closed(mesh.triangles);
    return imported;
}

}  // namespace assets
