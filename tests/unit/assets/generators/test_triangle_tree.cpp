#include "assets/generators/solid.h"
#include "assets/generators/triangle_tree.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace assets;

TEST_CASE("distances to a triangle where they are known") {
    const std::array<Vec3, 3> triangle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
    CHECK(squared_distance({1, 1, 3}, triangle) == Approx(9));   // face
    CHECK(squared_distance({2, -2, 0}, triangle) == Approx(4));  // edge
    CHECK(squared_distance({3, 3, 0}, triangle) == Approx(2));   // long edge
    CHECK(squared_distance({7, 0, 4}, triangle) == Approx(25));  // vertex
    const std::array<Vec3, 3> without_area{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
    CHECK(squared_distance({1, 3, 4}, without_area) == Approx(25));
}

TEST_CASE("the tree finds the distance to all triangles") {
    const TriangleMesh mesh =
        make_surface({Shape(Torus{{0, 0, 0}, {0, 0, 1}, 1, 0.4}), {}}, 0.2).mesh;
    std::vector<int> all(mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    const TriangleTree tree(mesh, all);
    for (int i = 0; i < 200; ++i) {
        const Vec3 x = 2 * Vec3::Random();
        double nearest = 1e9;
        for (const auto& [a, b, c] : mesh.triangles)
            nearest = std::min(
                nearest,
                squared_distance(x, {mesh.positions[a], mesh.positions[b], mesh.positions[c]}));
        CHECK(tree.distance(x) == std::sqrt(nearest));
    }
}
