#include "assets/mesh/triangle_mesh.h"

#include <catch2/catch.hpp>

using assets::TriangleMesh;

namespace {

// The tetrahedron of the origin and the unit points of the axes, of volume 1/6.
TriangleMesh tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
            {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
            {},
            {}};
}

}  // namespace

TEST_CASE("The volume of a tetrahedron is a sixth, wherever it is") {
    TriangleMesh mesh = tetrahedron();
    CHECK(signed_volume(mesh) == Approx(1.0 / 6).epsilon(1e-14));
    for (Vec3& x : mesh.positions)
        x += Vec3(1e6, -2e6, 3e6);
    // Positions this far out are exact, since whole: only the last digits of the products may
    // differ.
    CHECK(signed_volume(mesh) == Approx(1.0 / 6).epsilon(1e-14));
    for (auto& triangle : mesh.triangles)
        std::swap(triangle[0], triangle[1]);
    CHECK(signed_volume(mesh) == Approx(-1.0 / 6).epsilon(1e-14));
    CHECK(signed_volume(TriangleMesh{}) == 0);
}

TEST_CASE("Vertex normals are the sums of the area vectors around, made unit") {
    TriangleMesh mesh = tetrahedron();
    mesh.positions.emplace_back(5, 5, 5);  // used by no triangle
    const std::vector<Vec3> normals = vertex_normals(mesh);
    REQUIRE(normals.size() == 5);
    // At the origin three half-unit faces; at (1,0,0) those facing -z and -y, and the slanted
    // (1,1,1)/2.
    CHECK((normals[0] - Vec3(-1, -1, -1).normalized()).norm() < 1e-15);
    CHECK((normals[1] - Vec3(1, 0, 0)).norm() < 1e-15);
    CHECK(normals[4] == Vec3(0, 0, 0));
}
