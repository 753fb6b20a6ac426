// Eight Gauss points with F-bar.
#include "sim/elasticity/eight_point.h"
#include "sim/elasticity/elasticity.h"
#include "tests/support/box_body.h"
#include "tests/support/corner_fields.h"
#include "tests/support/derivative_order.h"
#include "tests/support/random_fields.h"
#include "tests/support/threads.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <catch2/catch.hpp>

#include <cmath>

using sim::Field;

namespace {

constexpr double s = 0.1;

struct Block {
    sim::Body body;
    sim::Lattice lattice;

    /// 3 × 2 × 2 domains, the last partly filled, of one law and nu = 0.45.
    explicit Block(sim::Model model) {
        body = tests::body_of(assets::Box{{0, 0, 0}, s * Vec3(3, 2, 2)}, s);
        body.regions[0].model = model;
        body.regions[0].poisson_ratio = 0.45;
        lattice = sim::make_lattice(body);
        lattice.fill.back() = 0.3;
    }

    Field rest() const { return tests::corners_at(lattice); }

    Field moved(const Mat3& F, const Vec3& by) const {
        return tests::corners_at(lattice, F, by);
    }
};

sim::Model any_law() {
    return GENERATE(
        sim::Model::NeoHookean, sim::Model::StableNeoHookean, sim::Model::FixedCorotated);
}

Mat3 some_rotation() {
    return Eigen::AngleAxisd(1.2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
}

/// Ψ by the formulas of the laws' headers.
double energy_density(sim::Model model, const Mat3& F, double mu, double lambda) {
    const double J = F.determinant(), I = F.squaredNorm() - 3;
    if (model == sim::Model::NeoHookean)
        return mu / 2 * I - mu * std::log(J) + lambda / 2 * std::log(J) * std::log(J);
    if (model == sim::Model::StableNeoHookean)
        return mu / 2 * I - mu * (J - 1) + (lambda + mu) / 2 * (J - 1) * (J - 1);
    const Vec3 stretches = Eigen::JacobiSVD<Mat3>(F).singularValues();
    return mu * (stretches - Vec3::Ones()).squaredNorm() + lambda / 2 * (J - 1) * (J - 1);
}

/// E = Σ_p V_p/8 Σ_g Ψ(F_g (J_c/J_g)^⅓), written out.
double plain_energy(const Block& block, const Field& x) {
    const sim::Lattice& lattice = block.lattice;
    double energy = 0;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        const double J_c = tests::gradient_at(lattice, p, x, Vec3::Constant(0.5)).determinant();
        for (int g = 0; g < 8; ++g) {
            Vec3 t;
            for (int k = 0; k < 3; ++k)
                t[k] = 0.5 + ((g >> k & 1) ? 0.5 : -0.5) / std::sqrt(3.0);
            const Mat3 F = tests::gradient_at(lattice, p, x, t);
            energy += lattice.domain_volume(p) / 8
                      * energy_density(block.body.regions[0].model,
                                       std::cbrt(J_c / F.determinant()) * F,
                                       lattice.mu[p],
                                       lattice.lambda[p]);
        }
    }
    return energy;
}

}  // namespace

TEST_CASE("eight points: the energy is that of the plain formula") {
    const Block block(any_law());
    sim::EightPoint energy(block.lattice, block.body);
    tests::Random random(1);
    const Field x =
        tests::sum(block.rest(), 1, tests::random_field(block.rest().size(), random, 0.2 * s));
    Field gradient(x.size());
    CHECK(energy.energy_and_gradient(x.data(), gradient.data())
          == Approx(plain_energy(block, x)).epsilon(1e-12));
}

TEST_CASE("eight points: the gradient is the derivative of the energy") {
    const Block block(any_law());
    sim::EightPoint energy(block.lattice, block.body);
    tests::Random random(2);
    const Field x =
        tests::sum(block.rest(), 1, tests::random_field(block.rest().size(), random, 0.15 * s));
    const Field u = tests::random_field(x.size(), random, s);
    Field gradient(x.size()), ignored(x.size());
    energy.energy_and_gradient(x.data(), gradient.data());
    const double slope = tests::dot(gradient, u);
    REQUIRE(std::abs(slope) > 0);
    const auto error = [&](double h) {
        const Field after = tests::sum(x, h, u), before = tests::sum(x, -h, u);
        return (energy.energy_and_gradient(after.data(), ignored.data())
                - energy.energy_and_gradient(before.data(), ignored.data()))
                   / (2 * h)
               - slope;
    };
    CHECK(tests::observed_order(error, 1e-2) == Approx(2).margin(0.1));
}

TEST_CASE("eight points: K is the derivative of the gradient, and symmetric") {
    const Block block(any_law());
    sim::EightPoint energy(block.lattice, block.body);
    tests::Random random(3);
    const Field x =
        tests::sum(block.rest(), 1, tests::random_field(block.rest().size(), random, 0.15 * s));
    const Field u = tests::random_field(x.size(), random, s),
                v = tests::random_field(x.size(), random, s);
    Field Ku(x.size()), Kv(x.size()), diagonal(x.size());
    energy.linearize(x.data(), false);
    energy.product(u.data(), Ku.data());
    energy.product(v.data(), Kv.data());
    REQUIRE(tests::dot(Ku, Ku) > 0);
    // Single precision keeps entries of both triangles alike; sums differ by rounding in double.
    CHECK(tests::dot(v, Ku) == Approx(tests::dot(u, Kv)).epsilon(1e-10));
    const auto error = [&](double h) {
        Field after(x.size()), before(x.size());
        energy.energy_and_gradient(tests::sum(x, h, u).data(), after.data());
        energy.energy_and_gradient(tests::sum(x, -h, u).data(), before.data());
        double largest = 0;
        for (std::size_t c = 0; c < x.size(); ++c)
            for (int i = 0; i < 3; ++i)
                largest = std::max(largest,
                                   std::abs((after[c][i] - before[c][i]) / (2 * h) - Ku[c][i]));
        return largest;
    };
    CHECK(tests::observed_order(error, 3e-2) == Approx(2).margin(0.15));
}

TEST_CASE("eight points: rigid motion costs nothing, and affine motion is exact") {
    const Block block(any_law());
    sim::EightPoint energy(block.lattice, block.body);
    const double scale = 1e6 * std::pow(s, 3);
    Field gradient(block.rest().size());
    const Field turned = block.moved(some_rotation(), Vec3(3, -1, 2));
    CHECK(std::abs(energy.energy_and_gradient(turned.data(), gradient.data())) < 1e-12 * scale);
    for (const sim::Vec3p& g : gradient)
        CHECK(std::sqrt(sim::dot(g, g)) < 1e-10 * scale / s);

    // The patch test [verification B2]: 60° and a stretch leave inner corners in balance.
    Mat3 F = Eigen::AngleAxisd(std::acos(-1.0) / 3, Vec3::UnitZ()).toRotationMatrix();
    F.col(0) *= 1.3;
    F(2, 1) += 0.2;
    Block filled = block;
    filled.lattice.fill.back() = 1;
    sim::EightPoint of_filled(filled.lattice, filled.body);
    const Field stretched = filled.moved(F, Vec3(0, 1, 0));
    const double volume = 12 * std::pow(s, 3);
    CHECK(of_filled.energy_and_gradient(stretched.data(), gradient.data())
          == Approx(volume
                    * energy_density(block.body.regions[0].model,
                                     F,
                                     filled.lattice.mu[0],
                                     filled.lattice.lambda[0]))
                 .epsilon(1e-12));
    int n_inner = 0;
    for (std::size_t c = 0; c < gradient.size(); ++c) {
        const auto& [x, y, z] = filled.lattice.corner_cell[c];
        if (x == 0 || x == 3 || y != 1 || z != 1)
            continue;
        ++n_inner;
        CHECK(std::sqrt(sim::dot(gradient[c], gradient[c])) < 1e-10 * scale / s);
    }
    CHECK(n_inner == 2);
}

TEST_CASE("eight points: a projected K has no negative curvature, the exact one has") {
    const Block block(any_law());
    sim::EightPoint energy(block.lattice, block.body);
    tests::Random random(4);
    const Field squashed =
        tests::sum(block.moved(Vec3(0.4, 1, 1).asDiagonal(), Vec3::Zero()),
                   1,
                   tests::random_field(block.rest().size(), random, 0.02 * s));
    const auto least_curvature = [&](bool project) {
        energy.linearize(squashed.data(), project);
        const auto n = static_cast<Eigen::Index>(3 * squashed.size());
        Eigen::MatrixXd K(n, n);
        for (Eigen::Index k = 0; k < n; ++k) {
            Field u(squashed.size()), Ku(squashed.size());
            u[k / 3][k % 3] = 1;
            energy.product(u.data(), Ku.data());
            for (Eigen::Index i = 0; i < n; ++i)
                K(i, k) = Ku[i / 3][i % 3];
        }
        const Eigen::VectorXd values =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly)
                .eigenvalues();
        return values[0] / values[n - 1];
    };
    CHECK(least_curvature(false) < -1e-3);
    CHECK(least_curvature(true) > -1e-6);  // single precision
}

TEST_CASE("eight points: a state inverted at one point is forbidden, and found") {
    const Block block(any_law());
    sim::EightPoint energy(block.lattice, block.body);
    Field x = block.rest(), gradient(x.size());
    // One corner pushed in so far that only the points near it turn over.
    const int corner = block.lattice.corners[0][0];
    x[corner] += sim::padded(0.75 * s * Vec3(1, 1, 1));
    CHECK(tests::gradient_at(block.lattice, 0, x, Vec3::Constant(0.5)).determinant() > 0);
    CHECK(std::isinf(energy.energy_and_gradient(x.data(), gradient.data())));
    CHECK(energy.smallest_J(x.data()).domain == 0);
    CHECK(energy.smallest_J(x.data()).J < 0);
}

TEST_CASE("eight points: no mode swings faster than the bound of explicit steps") {
    const Block block(sim::Model::NeoHookean);
    // w² <= 4 (3λ+2μ)/(ρ s²) for one domain with an eighth of its mass at each corner.
    sim::Lattice one = block.lattice;
    const double mu = one.mu[0], lambda = one.lambda[0];
    sim::EightPoint energy(one, block.body);
    const Field x = block.rest();
    energy.linearize(x.data(), false);
    tests::Random random(5);
    Field u = tests::random_field(x.size(), random, 1), Ku(x.size());
    double squared = 0;  // by the power method on M⁻¹K
    for (int k = 0; k < 300; ++k) {
        energy.product(u.data(), Ku.data());
        double MM = 0, KM = 0;
        for (std::size_t c = 0; c < x.size(); ++c) {
            KM += sim::dot(u[c], Ku[c]);
            MM += one.corner_mass[c] * sim::dot(u[c], u[c]);
        }
        squared = KM / MM;
        for (std::size_t c = 0; c < x.size(); ++c)
            u[c] = Ku[c] / (one.corner_mass[c] * squared);
    }
    const double bound = 4 * (3 * lambda + 2 * mu) / (1000 * s * s);
    CHECK(squared < bound);
    CHECK(squared > 0.05 * bound);
}

TEST_CASE("eight points: the same for any number of threads") {
    const sim::Body body = tests::box_body({20, 6, 6}, s);
    const sim::Lattice lattice = sim::make_lattice(body);
    tests::Random random(6);
    const Field rest = tests::corners_at(lattice);
    const Field u = tests::random_field(rest.size(), random, 0.1 * s),
                x = tests::sum(rest, 1, u);
    const auto run = [&] {
        sim::EightPoint energy(lattice, body);
        std::vector<double> numbers;
        Field out(x.size());
        numbers.push_back(energy.energy_and_gradient(x.data(), out.data()));
        const auto take = [&] {
            for (const sim::Vec3p& v : out)
                numbers.insert(numbers.end(), {v[0], v[1], v[2]});
        };
        take();
        energy.linearize(x.data(), true);
        energy.product(u.data(), out.data());
        take();
        energy.diagonal(out.data());
        take();
        return numbers;
    };
    CHECK(tests::on_threads(1, run) == tests::on_threads(2, run));
}
