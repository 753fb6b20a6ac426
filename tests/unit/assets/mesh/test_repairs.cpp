#include "assets/mesh/repair.h"
#include "tests/unit/assets/mesh/mesh_files.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <cmath>

using assets::ImportedMesh;
using assets::signed_volume;

namespace {

Polygons unit_box() {
    return box({0, 0, 0}, {1, 1, 1});
}

}  // namespace

TEST_CASE("A box inside out is turned") {
    const ImportedMesh imported = import_obj(as_obj(inside_out(unit_box())));
    CHECK(imported.closed);
    CHECK(signed_volume(imported.mesh) == Approx(1).epsilon(1e-14));
    REQUIRE(imported.repairs.size() == 1);
    CHECK(tells(imported.repairs, "1 part was inside out (of 1) and turned"));
}

TEST_CASE("Single faces the wrong way round are turned") {
    Polygons polygons = unit_box();
    std::swap(polygons.faces[0][1], polygons.faces[0][3]);
    const ImportedMesh imported = import_obj(as_obj(polygons));
    CHECK(imported.closed);
    CHECK(signed_volume(imported.mesh) == Approx(1).epsilon(1e-14));
    REQUIRE(imported.repairs.size() == 1);
    CHECK(tells(imported.repairs, "2 triangles were turned"));
}

TEST_CASE("Four faces of six the wrong way round: outside still wins over the majority") {
    Polygons polygons = unit_box();
    for (const int f : {0, 1, 2, 3})
        std::swap(polygons.faces[f][1], polygons.faces[f][3]);
    const ImportedMesh imported = import_obj(as_obj(polygons));
    CHECK(imported.closed);
    CHECK(signed_volume(imported.mesh) == Approx(1).epsilon(1e-14));
    CHECK(tells(imported.repairs, "8 triangles were turned"));
}

TEST_CASE("A box in a box faces outward too, whichever way the file has it") {
    const Polygons inner = box({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75});
    const ImportedMesh solid = import_obj(as_obj(unit_box() + inner));
    CHECK(solid.closed);
    CHECK(signed_volume(solid.mesh) == Approx(1.125).epsilon(1e-14));  // 1 + 1/8
    CHECK(solid.repairs.empty());

    const ImportedMesh cavity = import_obj(as_obj(unit_box() + inside_out(inner)));
    CHECK(signed_volume(cavity.mesh) == Approx(1.125).epsilon(1e-14));
    CHECK(tells(cavity.repairs, "1 part was inside out (of 2) and turned"));
    CHECK(tells(cavity.repairs, "no cavity"));
}

TEST_CASE("A box without its lid is open, faces outward, and says so") {
    Polygons polygons = unit_box();
    polygons.faces.pop_back();
    const ImportedMesh imported = import_obj(as_obj(inside_out(polygons)));
    CHECK_FALSE(imported.closed);
    CHECK(boundary_edge_count(imported.mesh) == 4);
    CHECK(tells(imported.repairs, "open: 4 boundary edges around 1 hole."));
    CHECK(tells(imported.repairs, "turned to face outward"));
    const assets::TriangleMesh& mesh = imported.mesh;
    const auto bottom = mesh.triangles.end() - 1;  // of the face z = 0
    const Vec3 normal = (mesh.positions[(*bottom)[1]] - mesh.positions[(*bottom)[0]])
                            .cross(mesh.positions[(*bottom)[2]] - mesh.positions[(*bottom)[0]]);
    CHECK(normal.z() < 0);
}

TEST_CASE("A sheet keeps the side that the file gives it, by the larger area") {
    const std::string positions = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 3 0 0\nv 3 1 0\n";
    const ImportedMesh down = import_obj(positions + "f 4 3 2 1\n");
    CHECK(vertex_normals(down.mesh)[0].z() == -1);
    // 1 m² down, 2 m² up.
    const ImportedMesh mixed = import_obj(positions + "f 4 3 2 1\nf 2 5 6 3\n");
    CHECK(vertex_normals(mixed.mesh)[0].z() == 1);
    CHECK(tells(mixed.repairs, "2 triangles were turned"));
}

TEST_CASE("A Moebius strip is told to be one-sided") {
    Polygons strip;
    constexpr int n = 12;
    for (int k = 0; k < n; ++k) {
        const double turn = 2 * M_PI * k / n;
        for (const double side : {-0.3, 0.3}) {
            const double radius = 1 + side * std::cos(turn / 2);
            strip.positions.emplace_back(
                radius * std::cos(turn), radius * std::sin(turn), side * std::sin(turn / 2));
        }
        const bool last = k == n - 1;
        strip.faces.push_back({2 * k, 2 * k + 1, last ? 0 : 2 * k + 3, last ? 1 : 2 * k + 2});
    }
    const ImportedMesh imported = import_obj(as_obj(strip));
    CHECK_FALSE(imported.closed);
    CHECK(tells(imported.repairs, "1 part is one-sided"));
}

TEST_CASE("Vertices at the same place are one, nearly the same are merged and told") {
    Polygons polygons = unit_box();
    polygons.positions.push_back(polygons.positions[0]);
    polygons.faces[0][0] = 8;
    const ImportedMesh same = import_obj(as_obj(polygons));
    CHECK(same.closed);
    CHECK(same.mesh.positions.size() == 8);
    CHECK(same.repairs.empty());

    polygons.positions[8] += Vec3(5e-7, 0, -5e-7);
    const ImportedMesh near = import_obj(as_obj(polygons));
    CHECK(near.closed);
    CHECK(near.mesh.positions.size() == 8);
    CHECK(tells(near.repairs, "1 vertex was merged"));

    polygons.positions[8] += Vec3(1e-5, 0, 0);  // beyond 1e-6 of the diagonal
    const ImportedMesh apart = import_obj(as_obj(polygons));
    CHECK_FALSE(apart.closed);
    CHECK(apart.mesh.positions.size() == 9);
}

TEST_CASE("Doubled triangles are dropped, whichever way they face") {
    const std::string obj = as_obj(unit_box());
    for (const std::string again : {"f 1 5 7\n", "f 7 5 1\n"}) {
        const ImportedMesh imported = import_obj(obj + again);
        CHECK(imported.closed);
        CHECK(imported.mesh.triangles.size() == 12);
        CHECK(tells(imported.repairs, "1 triangle was on the same three vertices"));
    }
}

TEST_CASE("Triangles without area are dropped unless they close the surface") {
    // Over an edge that two triangles share already: not needed.
    const ImportedMesh needless =
        import_obj(as_obj(unit_box()) + "f 1 1 2\nv 0.5 0 0\nf 1 9 2\n");
    CHECK(needless.closed);
    CHECK(needless.mesh.triangles.size() == 12);
    CHECK(tells(needless.repairs, "2 triangles were without area"));

    // Between a long edge and its two halves: without it the box would gape.
    Polygons split = unit_box();
    split.positions.emplace_back(0.5, 0, 0);
    split.faces[2] = {0, 8, 1, 5, 4};
    split.faces.push_back({0, 1, 8});
    const ImportedMesh closing = import_obj(as_obj(split));
    CHECK(closing.closed);
    CHECK(closing.mesh.triangles.size() == 14);
    CHECK(signed_volume(closing.mesh) == Approx(1).epsilon(1e-14));
}

TEST_CASE("Edges with more than two triangles are told with their place") {
    const ImportedMesh fin = import_obj(as_obj(unit_box()) + "v 2 2 2\nf 7 8 9\n");
    CHECK_FALSE(fin.closed);
    CHECK(tells(fin.repairs, "1 edge has more than two triangles, the first at (0.5, 1, 1) m"));

    // Two boxes that touch along an edge: nothing is open, yet it is not a simple closed surface.
    const ImportedMesh touching =
        import_obj(as_obj(unit_box() + inside_out(box({1, 1, 0}, {2, 2, 1}))));
    CHECK_FALSE(touching.closed);
    CHECK(boundary_edge_count(touching.mesh) == 0);
    CHECK(tells(touching.repairs, "1 edge has more than two triangles"));
    CHECK(signed_volume(touching.mesh) == Approx(2).epsilon(1e-14));
}

TEST_CASE("Lines are left out and told") {
    const ImportedMesh imported = import_obj(as_obj(unit_box()) + "l 1 2\n");
    CHECK(imported.closed);
    CHECK(tells(imported.repairs, "1 line or point was left out"));
}
