#include "sim/embedding/embedding.h"
#include "tests/unit/sim/lattice/bodies.h"

#include <catch2/catch.hpp>

#include <numeric>

using namespace sim;

namespace {

constexpr double rounding = 1e-12;  // of a body of about a metre

const assets::Torus torus{{0.1, 0.2, 0.3}, {1, 2, 3}, 0.6, 0.2};

std::vector<Vec3> random_points(int n) {
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i)
        points.push_back(Vec3(0.1, 0.2, 0.3) + Vec3::Random());
    return points;
}

/// Distance to the cube of a domain.
double distance(const Lattice& lattice, int p, const Vec3& X) {
    const Vec3 low = lattice.corner_rest[lattice.corners[p][0]];
    return (low - X).cwiseMax(X - low - Vec3::Constant(lattice.edge)).cwiseMax(0.0).norm();
}

}  // namespace

TEST_CASE("points bind to the nearest domain, by weights that sum to 1") {
    const Lattice lattice = make_lattice(body(torus, 0.1));
    const std::vector<Vec3> points = random_points(500);
    const std::vector<Binding> bindings = bind_points(lattice, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        double nearest = 1e9;
        for (int p = 0; p < lattice.n_domains(); ++p)
            nearest = std::min(nearest, distance(lattice, p, points[i]));
        CHECK(distance(lattice, bindings[i].domain, points[i])
              == Approx(nearest).margin(rounding));
        const auto& weights = bindings[i].weights;
        CHECK(std::accumulate(weights.begin(), weights.end(), 0.0)
              == Approx(1).epsilon(rounding));
    }
}

TEST_CASE("an affine motion is reproduced") {
    const Lattice lattice = make_lattice(body(torus, 0.1));
    const Mat3 A = Mat3::Identity() + 0.5 * Mat3::Random();
    const Vec3 b(1, -2, 3);
    std::vector<Vec3> corners;
    for (const Vec3& X : lattice.corner_rest)
        corners.push_back(A * X + b);
    const std::vector<Vec3> points = random_points(2500);
    const std::vector<Binding> bindings = bind_points(lattice, points);
    int reached = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (distance(lattice, bindings[i].domain, points[i]) > 0.5 * lattice.edge)
            continue;
        ++reached;
        CHECK((carried(lattice, bindings[i], corners) - A * points[i] - b).norm()
              < 10 * rounding);
        CHECK((deformation_gradient(lattice, bindings[i], corners) - A).norm()
              < 100 * rounding);
        CHECK((deformation_gradient(lattice, bindings[i].domain, corners) - A).norm()
              < 100 * rounding);
    }
    CHECK(reached > 300);
}

TEST_CASE("the deformation gradient is the derivative of the carried position") {
    const Lattice lattice = make_lattice(body(assets::Box{{0, 0, 0}, {1, 1, 1}}, 1));
    std::vector<Vec3> corners;
    for (const Vec3& X : lattice.corner_rest)
        corners.push_back(X + 0.3 * Vec3::Random());
    const Vec3 X(0.2, 0.7, 0.4);
    // Central differences are exact: the map is linear along each axis.
    constexpr double h = 0.1;
    const Mat3 F = deformation_gradient(lattice, bind_points(lattice, {X})[0], corners);
    for (int j = 0; j < 3; ++j) {
        const auto ends = bind_points(lattice, {X - h * Vec3::Unit(j), X + h * Vec3::Unit(j)});
        const Vec3 slope =
            (carried(lattice, ends[1], corners) - carried(lattice, ends[0], corners)) / (2 * h);
        CHECK((F.col(j) - slope).norm() < 10 * rounding);
    }
}

TEST_CASE("extrapolation ends half a domain outside") {
    const Lattice lattice = make_lattice(body(assets::Box{{0, 0, 0}, {3, 2, 1}}, 1));
    const auto bound_at = [&](const Vec3& X) {
        return carried(lattice, bind_points(lattice, {X})[0], lattice.corner_rest);
    };
    CHECK((bound_at({3.25, 1, 0.5}) - Vec3(3.25, 1, 0.5)).norm() < rounding);
    CHECK((bound_at({30, 1, 0.5}) - Vec3(3.5, 1, 0.5)).norm() < rounding);
    CHECK((bound_at({-9, -9, 0.5}) - Vec3(-0.5, -0.5, 0.5)).norm() < rounding);
}
