// Meshes that are not part of the project: read where the environment says they are.
#include "assets/mesh/import.h"
#include "assets/mesh/repair.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <optional>

using assets::ImportedMesh;

namespace {

std::optional<ImportedMesh> read(const std::string& name) {
    const char* folder = std::getenv("SUPPLE_TEST_MESHES");
    if (folder == nullptr) {
        WARN("skipped: SUPPLE_TEST_MESHES names no folder with " << name);
        return std::nullopt;
    }
    return assets::import_mesh(std::filesystem::path(folder) / name);
}

// #V - #E + #T, two for a closed surface without handles.
int euler_characteristic(const assets::TriangleMesh& mesh) {
    int n_edges = 0;
    const auto uses = assets::sorted_edge_uses(mesh.triangles);
    assets::for_each_edge(uses, [&](auto) { ++n_edges; });
    return static_cast<int>(mesh.positions.size() + mesh.triangles.size()) - n_edges;
}

}  // namespace

TEST_CASE("Spot, quads with seams of texture, is a closed surface") {
    if (const auto spot = read("spot.obj")) {
        CHECK(spot->closed);
        CHECK(spot->mesh.positions.size() == 2930);  // the "v" lines of the file
        CHECK(euler_characteristic(spot->mesh) == 2);
        CHECK(signed_volume(spot->mesh) > 0);
    }
}

TEST_CASE("The bunny of Stanford has five holes") {
    if (const auto bunny = read("stanford-bunny.obj")) {
        CHECK_FALSE(bunny->closed);
        CHECK(bunny->mesh.triangles.size() == 69451);  // the "f" lines of the file
        CHECK(find_holes(bunny->mesh).size() == 5);
        CHECK(euler_characteristic(bunny->mesh) == 2 - 5);
        std::vector<std::string> repairs;
        const assets::TriangleMesh closed = close_holes(bunny->mesh, &repairs);
        CHECK(assets::is_closed(closed.triangles));
        CHECK(euler_characteristic(closed) == 2);
    }
}

TEST_CASE("Suzanne and the teapot are open") {
    for (const std::string name : {"suzanne.obj", "teapot.obj"}) {
        if (const auto mesh = read(name)) {
            INFO(name);
            CHECK_FALSE(mesh->closed);
            CHECK(boundary_edge_count(mesh->mesh) > 0);
        }
    }
}
