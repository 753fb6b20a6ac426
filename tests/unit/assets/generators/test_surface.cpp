#include "assets/generators/solid.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <set>

using namespace assets;

namespace {

const double pi = std::acos(-1.0);

/// Every directed edge once, and its opposite once.
bool is_closed(const TriangleMesh& mesh) {
    std::set<std::pair<int, int>> edges;
    for (const auto& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i)
            if (!edges.insert({triangle[i], triangle[(i + 1) % 3]}).second)
                return false;
    for (const auto& [a, b] : edges)
        if (!edges.count({b, a}))
            return false;
    return true;
}

double area(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += (mesh.positions[b] - mesh.positions[a])
                   .cross(mesh.positions[c] - mesh.positions[a])
                   .norm()
               / 2;
    return sum;
}

/// Area of the triangles whose middle is off the surface by more than a twentieth of their edge. On a radius of 0.3
/// chords of 0.02 sag by 0.02^2 / (2 * 0.3), a thirtieth.
double chamfer(const TriangleMesh& mesh, const Shape& shape, double edge) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 &x = mesh.positions[a], &y = mesh.positions[b], &z = mesh.positions[c];
        if (std::abs(signed_distance(shape, (x + y + z) / 3)) > edge / 20)
            sum += (y - x).cross(z - x).norm() / 2;
    }
    return sum;
}

struct Known {
    Shape shape;
    double volume, area;
};

const std::vector<Known> curved = {
    {Sphere{{0.3, -0.2, 0.1}, 0.7}, 4.0 / 3 * pi * 0.343, 4 * pi * 0.49},
    {Cylinder{{0, 0, 0}, {0, 0, 1}, 0.4}, pi * 0.16, 2 * pi * 0.4 * (1 + 0.4)},
    {Cylinder{{0, 0, 0}, {0.6, 0, 0.8}, 0.4}, pi * 0.16, 2 * pi * 0.4 * (1 + 0.4)},
    {Capsule{{0.2, 0, 0}, {0.2, 0, 1}, 0.3},
     pi * 0.09 + 4.0 / 3 * pi * 0.027,
     2 * pi * 0.3 + 4 * pi * 0.09},
    {Torus{{0, 0.1, 0}, {1, 1, 3}, 0.8, 0.25},
     2 * pi* pi * 0.8 * 0.0625,
     4 * pi* pi * 0.8 * 0.25},
    // Prolate, of eccentricity e = 0.8: area 2 pi a^2 (1 + c / (a e) asin e).
    {Ellipsoid{{0.1, 0, 0}, {0.6, 0.6, 1}},
     4.0 / 3 * pi * 0.36,
     2 * pi * 0.36 * (1 + std::asin(0.8) / (0.6 * 0.8))}};

}  // namespace

TEST_CASE(
    "curved shapes are meshed closed, on their surface, facing out, with the right volume and "
    "area") {
    for (const Known& known : curved) {
        const TriangleMesh mesh = make_surface({known.shape, {}}, 0.05).mesh;
        INFO("shape " << known.shape.index());
        CHECK(is_closed(mesh));
        double farthest = 0;
        for (const Vec3& x : mesh.positions)
            farthest = std::max(farthest, std::abs(signed_distance(known.shape, x)));
        CHECK(farthest < 1e-9);
        // Chords of 0.05 on a radius of 0.25 stay within 0.05^2 / (8 * 0.25) = 0.5 % of the radius.
        CHECK(signed_volume(mesh) == Approx(known.volume).epsilon(0.01));
        CHECK(area(mesh) == Approx(known.area).epsilon(0.01));
        CHECK(signed_volume(mesh)
              < known.volume * (1 + 1e-9) + (known.shape.index() == 4 ? 1 : 0));
    }
}

TEST_CASE("a cylinder keeps flat ends and crisp rims") {
    const Cylinder cylinder{{0.1, 0.2, 0.3}, {0.7, 0.2, 1.1}, 0.4};
    const Vec3 axis(0.6, 0, 0.8);
    const TriangleMesh mesh = make_surface({Shape(cylinder), {}}, 0.05).mesh;
    double chamfer = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 doubled = (mesh.positions[b] - mesh.positions[a])
                                 .cross(mesh.positions[c] - mesh.positions[a]);
        const double along = std::abs(doubled.normalized().dot(axis));
        if (along > 0.2 && along < 0.98)
            chamfer += doubled.norm() / 2;
    }
    CHECK(chamfer < 0.01 * area(mesh));
}

TEST_CASE("combined shapes are meshed closed, on their surface, with crisp edges") {
    const Sphere ball{{0.1, 0, 0}, 0.5};
    const Shape half = Combination{
        Combination::Kind::Intersection, {{ball}, {Box{{-1, -1, -1}, {1, 1, 0}}}}, 0};
    const Shape bowl =
        Combination{Combination::Kind::Difference, {{half}, {Sphere{{0.1, 0, 0}, 0.3}}}, 0};
    const double of_ball = 4.0 / 3 * pi * 0.125, of_hole = 4.0 / 3 * pi * 0.027;
    for (const auto& [shape, volume] :
         {std::pair(half, of_ball / 2), std::pair(bowl, (of_ball - of_hole) / 2)}) {
        constexpr double spacing = 0.02;
        const TriangleMesh mesh = make_surface({shape, {}}, spacing).mesh;
        CHECK(is_closed(mesh));
        for (const Vec3& x : mesh.positions)
            CHECK(std::abs(signed_distance(shape, x)) < 1e-6 * spacing);
        // Chords lose spacing^2 / (8 r) of r on the balls, two thousandths of their volume where r = 0.3.
        CHECK(signed_volume(mesh) == Approx(volume).epsilon(0.003));
        CHECK(chamfer(mesh, shape, spacing) < 0.001 * area(mesh));
    }
}

TEST_CASE("a box is tessellated exactly") {
    const Box box{{0, -1, 2}, {1, 1, 2.5}};
    const TriangleMesh mesh = make_surface({Shape(box), {}}, 0.25).mesh;
    CHECK(is_closed(mesh));
    CHECK(signed_volume(mesh) == Approx(1).epsilon(1e-12));
    CHECK(area(mesh) == Approx(2 * (2 + 0.5 + 1)).epsilon(1e-12));
    // 4 x 8 x 2 rectangles: a closed surface of F quads has F + 2 vertices.
    const std::size_t quads = 2 * (4 * 8 + 8 * 2 + 4 * 2);
    CHECK(mesh.triangles.size() == 2 * quads);
    CHECK(mesh.positions.size() == quads + 2);
    for (const Vec3& x : mesh.positions)
        CHECK(signed_distance(box, x) == 0);
}

TEST_CASE("a moved surface is the surface moved") {
    const Transform transform{2, {0.3, 0.2, 0.1}, {5, 6, 7}};
    const Sphere sphere{{1, 0, 0}, 0.5};
    const TriangleMesh mesh = make_surface({Shape(sphere), transform}, 0.2).mesh;
    for (const Vec3& x : mesh.positions)
        CHECK((x - apply(transform, sphere.center)).norm() == Approx(1));
    CHECK(mesh.positions.size()
          == make_surface({Shape(sphere), {}}, 0.1).mesh.positions.size());
}

TEST_CASE("surfaces are the same for any number of threads") {
    const Source torus{curved[4].shape, {}};
    const TriangleMesh with_all = make_surface(torus, 0.05).mesh;
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const TriangleMesh with_one = make_surface(torus, 0.05).mesh;
    CHECK(with_all.positions == with_one.positions);
    CHECK(with_all.triangles == with_one.triangles);
}
