#include "sim/elasticity/highest_frequency.h"
#include "sim/mapped_frequency.h"
#include "tests/support/box_body.h"
#include "tests/support/corner_fields.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include <cmath>

using sim::Field;

namespace {

constexpr double s = 0.1;

/// The largest w of TᵀK T q = w² (Tᵀm) q at rest of the body whose corners begin with `first`, from all of it.
double by_eigenvalues(sim::ElasticEnergy& energy,
                      const sim::Lattice& lattice,
                      const sim::CornerMap& map,
                      int first) {
    const int n = map.n_dofs();
    const std::size_t n_corners = map.dof_of_corner().size();
    energy.linearize(tests::corners_at(lattice).data(), false);
    Field masses(n_corners), u(n_corners), f(n_corners), lumped(n), column(n);
    for (int c = 0; c < lattice.n_corners(); ++c)
        masses[first + c] = sim::padded(Vec3::Constant(lattice.corner_mass[c]));
    map.apply_transposed(masses, lumped);
    Eigen::MatrixXd scaled = Eigen::MatrixXd::Zero(3 * n, 3 * n);  // M^-½ TᵀK T M^-½
    for (int k = 0; k < 3 * n; ++k) {
        Field q(n);
        if (!(lumped[k / 3][0] > 0))
            continue;
        q[k / 3][k % 3] = 1 / std::sqrt(lumped[k / 3][0]);
        map.apply(q, u);
        energy.product(&u[first], &f[first]);
        map.apply_transposed(f, column);
        for (int r = 0; r < 3 * n; ++r)
            if (lumped[r / 3][0] > 0)
                scaled(r, k) = column[r / 3][r % 3] / std::sqrt(lumped[r / 3][0]);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled, Eigen::EigenvaluesOnly);
    return std::sqrt(solver.eigenvalues().maxCoeff());
}

}  // namespace

TEST_CASE(
    "the highest frequency under a map is that of the largest eigenvalue of what it lets "
    "through") {
    sim::Body body = tests::box_body({4, 3, 3}, s);
    body.regions.push_back(
        tests::region("stiff", tests::behind(s * Vec3(2, 0, 0), Vec3(1, 0, 0)), 4e5));
    const sim::Lattice lattice = sim::make_lattice(body);
    const auto energy = sim::make_elastic_energy(lattice, body, sim::Quadrature::OnePoint);
    const int n = lattice.n_corners();
    const double whole = sim::highest_frequency(*energy, lattice);

    // The second of two bodies of one shape, with few free corners, and with a plane of them.
    const int free_plane = GENERATE(-1, 2);
    Field corners = tests::corners_at(lattice);
    for (int c = 0; c < n; ++c)
        corners.push_back(corners[c]);
    std::vector<char> free(2 * n, 0);
    for (int c = 0; c < n; ++c)
        free[n + c] = lattice.corner_cell[c][0] == free_plane;
    sim::CornerMap map;
    map.rebuild(corners, free, {{0, n, 2 * s}, {n, 2 * n, 2 * s}});
    const double expected = by_eigenvalues(*energy, lattice, map, n),
                 found = sim::highest_frequency(*energy, lattice, map, 1, n);
    CHECK(found <= (1 + 1e-12) * expected);
    CHECK(found >= 0.98 * expected);
    CHECK(expected < (free_plane < 0 ? 0.6 : 1) * whole);
}
