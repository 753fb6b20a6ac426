#include "assets/generators/solid.h"
#include "sim/embedding/creases.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

using namespace sim;

namespace {

constexpr double crease = 0.7;  // 40 degrees [rad]

assets::TriangleMesh surface_of(assets::Shape shape, double spacing) {
    return assets::make_surface({shape, {}}, spacing).mesh;
}

}  // namespace

TEST_CASE("a box has the normals of its faces, on vertices of their own") {
    const assets::TriangleMesh mesh = surface_of(assets::Box{{0, 0, 0}, {1, 1, 1}}, 0.25);
    const CreasedMesh split = split_creases(mesh, crease);
    CHECK(split.positions.size() == 6 * 25);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = split.triangles[t];
        const Vec3 normal = (split.positions[b] - split.positions[a])
                                .cross(split.positions[c] - split.positions[a]);
        for (int i = 0; i < 3; ++i) {
            CHECK((split.normals[split.triangles[t][i]] - normal.normalized()).norm() < 1e-12);
            CHECK(split.positions[split.triangles[t][i]]
                  == mesh.positions[mesh.triangles[t][i]]);
        }
    }
}

TEST_CASE("a sphere stays whole, with normals along its radii") {
    const assets::TriangleMesh mesh = surface_of(assets::Sphere{{0, 0, 0}, 1}, 0.1);
    const CreasedMesh split = split_creases(mesh, crease);
    CHECK(split.positions.size() == mesh.positions.size());
    for (std::size_t v = 0; v < split.positions.size(); ++v)
        CHECK((split.normals[v] - split.positions[v]).norm() < 0.05);
}

TEST_CASE("triangles without area leave normals unit") {
    assets::TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    for (const Vec3& normal : split_creases(mesh, crease).normals)
        CHECK(normal.norm() == Approx(1));
}
