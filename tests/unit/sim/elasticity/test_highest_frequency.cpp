#include "sim/elasticity/highest_frequency.h"
#include "tests/support/box_body.h"
#include "tests/support/corner_fields.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include <cmath>

using sim::Field;

namespace {

constexpr double s = 0.1;

/// 5 × 4 × 3 domains, soft but for two columns, the outer ones on one side partly filled.
sim::Body some_body() {
    sim::Body body = tests::body_of(assets::Box{{0, 0, 0}, s * Vec3(4.4, 4, 3)}, s);
    body.regions[0].young_modulus = 1e5;
    body.regions.push_back(
        tests::region("stiff", tests::behind(s * Vec3(2, 0, 0), Vec3(1, 0, 0)), 4e5));
    body.regions[1].density = 2000;
    return body;
}

/// The largest w of K u = w² M u, K at x, from all of it, a column a product.
double by_eigenvalues(sim::ElasticEnergy& energy, const sim::Lattice& lattice, const Field& x) {
    const int n = lattice.n_corners();
    Field u(n), product(n);
    energy.linearize(x.data(), false);
    Eigen::MatrixXd scaled(3 * n, 3 * n);  // M^-½ K M^-½
    for (int column = 0; column < 3 * n; ++column) {
        u.assign(n, sim::Vec3p{});
        u[column / 3][column % 3] = 1 / std::sqrt(lattice.corner_mass[column / 3]);
        energy.product(u.data(), product.data());
        for (int row = 0; row < 3 * n; ++row)
            scaled(row, column) =
                product[row / 3][row % 3] / std::sqrt(lattice.corner_mass[row / 3]);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled, Eigen::EigenvaluesOnly);
    return std::sqrt(solver.eigenvalues().maxCoeff());
}

}  // namespace

TEST_CASE("the highest frequency is that of the largest eigenvalue") {
    const sim::Quadrature quadrature =
        GENERATE(sim::Quadrature::OnePoint, sim::Quadrature::EightPoint);
    const sim::Body body = some_body();
    const sim::Lattice lattice = sim::make_lattice(body);
    const auto energy = sim::make_elastic_energy(lattice, body, quadrature);
    const double expected = by_eigenvalues(
                     *energy, lattice, tests::corners_at(lattice, Mat3::Identity())),
                 found = sim::highest_frequency(*energy, lattice);
    CHECK(found <= (1 + 1e-12) * expected);
    CHECK(found >= 0.98 * expected);
}

TEST_CASE("a body that is pressed or pulled gets no faster than it stiffens") {
    const sim::Quadrature quadrature =
        GENERATE(sim::Quadrature::OnePoint, sim::Quadrature::EightPoint);
    const sim::Model model = GENERATE(
        sim::Model::NeoHookean, sim::Model::StableNeoHookean, sim::Model::FixedCorotated);
    const Vec3 stretches = GENERATE(
        Vec3(1, 1, 0.6), Vec3(0.7, 0.7, 0.7), Vec3(1.8, 0.8, 0.8), Vec3(1.4, 1.4, 0.5));
    CAPTURE(int(quadrature), int(model), stretches.transpose());
    sim::Body body = some_body();
    for (sim::Region& region : body.regions)
        region.model = model;
    const sim::Lattice lattice = sim::make_lattice(body);
    const auto energy = sim::make_elastic_energy(lattice, body, quadrature);
    const Field rest = tests::corners_at(lattice, Mat3::Identity()),
                x = tests::corners_at(lattice, stretches.asDiagonal());
    REQUIRE(energy->stiffening(rest.data()) == Approx(1).epsilon(1e-12));
    const double faster =
        by_eigenvalues(*energy, lattice, x) / by_eigenvalues(*energy, lattice, rest);
    CHECK(faster < 1.02 * std::sqrt(energy->stiffening(x.data())));
}

TEST_CASE("the fastest mode of a large block is a pressure wave of two domain edges") {
    // w = 2 c / s with c² = (λ+2μ)/rho; at the sides, which are free, hourglass modes may be a little faster.
    const sim::Body body = tests::box_body({12, 12, 12}, s);
    const sim::Lattice lattice = sim::make_lattice(body);
    const auto energy = sim::make_elastic_energy(lattice, body, sim::Quadrature::OnePoint);
    const double c = std::sqrt((lattice.lambda[0] + 2 * lattice.mu[0]) / lattice.density[0]);
    CHECK(sim::highest_frequency(*energy, lattice) == Approx(2 * c / s).epsilon(0.03));
}
