#include "assets/mesh/repair.h"
#include "tests/unit/assets/mesh/mesh_files.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using assets::Hole;
using assets::TriangleMesh;

namespace {

TriangleMesh box_without(const std::vector<int>& faces) {
    Polygons polygons = box({0, 0, 0}, {1, 1, 1});
    for (const int f : faces)
        polygons.faces.erase(polygons.faces.begin() + f);
    return import_obj(as_obj(polygons)).mesh;
}

}  // namespace

TEST_CASE("A hole is measured") {
    const TriangleMesh open = box_without({5});  // the lid
    const std::vector<Hole> holes = find_holes(open);
    REQUIRE(holes.size() == 1);
    CHECK(holes[0].edges.size() == 4);
    CHECK((holes[0].center - Vec3(0.5, 0.5, 1)).norm() < 1e-15);
    CHECK(holes[0].size == Approx(std::sqrt(2)));
    CHECK(holes[0].unevenness < 1e-15);
    CHECK(find_holes(box_without({})).empty());
}

TEST_CASE("Holes are closed, facing as their neighbours do") {
    const TriangleMesh open = box_without({5, 4});  // lid and bottom
    std::vector<std::string> repairs;
    const TriangleMesh closed = close_holes(open, &repairs);
    CHECK(assets::is_closed(closed.triangles));
    CHECK(boundary_edge_count(closed) == 0);
    CHECK(closed.positions.size() == open.positions.size() + 2);
    CHECK(signed_volume(closed) == Approx(1).epsilon(1e-14));
    REQUIRE(repairs.size() == 2);
    CHECK(repairs[0] == "A hole of 4 edges, 1.41 m across, was closed.");
}

TEST_CASE("A corner taken off leaves an uneven hole, closed by a fan about its middle") {
    // Two neighbouring faces: a bent hole of six edges.
    const TriangleMesh open = box_without({5, 3});
    const std::vector<Hole> holes = find_holes(open);
    REQUIRE(holes.size() == 1);
    CHECK(holes[0].edges.size() == 6);
    // The corners (0,0,1) and (1,0,1), (0,1,0) and (1,1,0) lie in the plane y + z = 1, the other
    // two in y + z = 2.
    CHECK(holes[0].unevenness > 0.1);
    std::vector<std::string> repairs;
    CHECK(assets::is_closed(close_holes(open, &repairs).triangles));
}

TEST_CASE("Closed holes inherit the group of each neighbour") {
    TriangleMesh open = box_without({5});
    open.groups = {"low", "side"};
    open.triangle_group.assign(open.triangles.size(), 1);
    open.triangle_group.back() = 0;
    std::vector<std::string> repairs;
    const TriangleMesh closed = close_holes(open, &repairs);
    REQUIRE(closed.triangle_group.size() == 14);
    for (size_t t = 10; t < 14; ++t)
        CHECK(closed.triangle_group[t] == 1);
}

TEST_CASE("Two holes that touch in one vertex are closed as two") {
    // A sheet of 4 x 4 squares without two that meet at a corner: its rim, and two holes of four
    // edges.
    Polygons sheet;
    for (int v = 0; v < 25; ++v)
        sheet.positions.emplace_back(v % 5, v / 5, 0);
    for (int v = 0; v < 19; ++v) {
        if (v % 5 != 4 && v != 6 && v != 12)
            sheet.faces.push_back({v, v + 1, v + 6, v + 5});
    }
    const TriangleMesh open = import_obj(as_obj(sheet)).mesh;
    const std::vector<Hole> holes = find_holes(open);
    REQUIRE(holes.size() == 3);
    std::vector<size_t> sizes;
    for (const Hole& hole : holes)
        sizes.push_back(hole.edges.size());
    std::sort(sizes.begin(), sizes.end());
    CHECK(sizes == std::vector<size_t>{4, 4, 16});
    std::vector<std::string> repairs;
    CHECK(assets::is_closed(close_holes(open, &repairs).triangles));
}

TEST_CASE("Boundary edges that form no loop stay open and are told") {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 2}};  // neighbours that face oppositely
    std::vector<std::string> repairs;
    const TriangleMesh result = close_holes(mesh, &repairs);
    CHECK(result.triangles.size() == 2);
    REQUIRE(repairs.size() == 1);
    CHECK(repairs[0] == "4 edges stay open: they form no simple loop.");
}
