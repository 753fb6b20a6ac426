#include "assets/mesh/polygon.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <cmath>

using assets::triangulate;

namespace {

// Sums of the triangles' area vectors, and of their lengths: they agree where no triangle is turned
// over.
std::pair<Vec3, double> area(const std::vector<Vec3>& corners) {
    Vec3 vector = Vec3::Zero();
    double total = 0;
    for (const auto& [a, b, c] : triangulate(corners)) {
        const Vec3 of_triangle = (corners[b] - corners[a]).cross(corners[c] - corners[a]) / 2;
        vector += of_triangle;
        total += of_triangle.norm();
    }
    return {vector, total};
}

}  // namespace

TEST_CASE("Polygons are cut into triangles that cover them once") {
    const std::vector<Vec3> triangle = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<Vec3> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<Vec3> arrow = {
        {0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}};  // reflex at the third
    const std::vector<Vec3> u_shape = {
        {0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
    const std::vector<std::pair<std::vector<Vec3>, double>> polygons_and_areas = {
        {triangle, 0.5}, {square, 1}, {arrow, 0.5}, {u_shape, 7}};
    for (const auto& [corners, expected] : polygons_and_areas) {
        CHECK(triangulate(corners).size() == corners.size() - 2);
        const auto [vector, total] = area(corners);
        CHECK((vector - Vec3(0, 0, expected)).norm() < 1e-14);
        CHECK(total == Approx(expected).epsilon(1e-14));
    }
}

TEST_CASE("A regular polygon in a slanted plane keeps its area and direction") {
    const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
    constexpr int n = 17;
    std::vector<Vec3> corners;
    for (int k = 0; k < n; ++k) {
        const double angle = 2 * M_PI * k / n;
        corners.push_back(turn * Vec3(std::cos(angle), std::sin(angle), 0));
    }
    const double expected = 0.5 * n * std::sin(2 * M_PI / n);
    const auto [vector, total] = area(corners);
    CHECK((vector - turn * Vec3(0, 0, expected)).norm() < 1e-13);
    CHECK(total == Approx(expected).epsilon(1e-13));
}

TEST_CASE("Polygons without area or with crossings still give n - 2 triangles") {
    const Vec3 p(1, 1, 1);
    CHECK(triangulate(std::vector<Vec3>{p, p, p, p, p}).size() == 3);
    const std::vector<Vec3> bow_tie = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    CHECK(triangulate(bow_tie).size() == 2);
}
