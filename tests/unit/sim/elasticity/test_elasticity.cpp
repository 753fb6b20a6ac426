#include "sim/elasticity/elasticity.h"
#include "tests/support/corner_fields.h"
#include "tests/support/random_fields.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <limits>

using sim::Field;
using sim::Vec3p;
using tests::corners_at;
using tests::dot;
using tests::gradient_at;
using tests::sum;

namespace {

struct Block {
    sim::Body body;
    sim::Lattice lattice;
};

/// A box of nx × ny × nz domains of edge 0.1; where there are several along x with two laws, so that batches are mixed.
Block block(const std::array<int, 3>& n) {
    Block result;
    sim::Body& body = result.body;
    body.name = "block";
    body.domain_size = 0.1;
    body.source.geometry =
        assets::Shape{assets::Box{{0, 0, 0}, {0.1 * n[0], 0.1 * n[1], 0.1 * n[2]}}};
    sim::Region region;
    region.name = "log";
    region.select.is = sim::Selector::All{};
    region.model = sim::Model::NeoHookean;
    region.young_modulus = 1e5;
    region.poisson_ratio = 0.3;
    region.density = 1000;
    body.regions.push_back(region);
    if (n[0] > 1) {
        region.name = "corotated";
        region.model = sim::Model::FixedCorotated;
        region.young_modulus = 3e5;
        region.select.is = sim::Selector::HalfSpace{{0.1, 0, 0}, {1, 0, 0}};
        body.regions.push_back(region);
    }
    result.lattice = sim::make_lattice(body);
    return result;
}

Field random_field(int n, double size, unsigned seed) {
    tests::Random random(seed);
    return tests::random_field(n, random, size);
}

/// The energy by the plain formulas: one point, and the hourglass sum over eight Gauss points.
double plain_energy(const Block& block, const Field& x) {
    const sim::Lattice& lattice = block.lattice;
    double energy = 0;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        const double mu = lattice.mu[p], lambda = lattice.lambda[p],
                     nu = lambda / (2 * (lambda + mu));
        const Mat3 F = gradient_at(lattice, p, x, Vec3::Constant(0.5));
        const double J = F.determinant();
        double psi = 0;
        if (block.body.regions[lattice.region[p]].model == sim::Model::NeoHookean) {
            psi = mu / 2 * (F.squaredNorm() - 3) - mu * std::log(J)
                  + lambda / 2 * std::log(J) * std::log(J);
        } else {
            const Vec3 stretches = Eigen::SelfAdjointEigenSolver<Mat3>(F.transpose() * F)
                                       .eigenvalues()
                                       .cwiseSqrt();
            psi =
                mu * (stretches - Vec3::Ones()).squaredNorm() + lambda / 2 * (J - 1) * (J - 1);
        }
        double hourglass = 0;
        for (int g = 0; g < 8; ++g) {
            Vec3 t;
            for (int k = 0; k < 3; ++k)
                t[k] = 0.5 + ((g >> k & 1) ? 0.5 : -0.5) / std::sqrt(3.0);
            hourglass += (gradient_at(lattice, p, x, t) - F).squaredNorm() / 8;
        }
        energy += lattice.domain_volume(p) * (psi + (1 + nu) / 2 * mu * hourglass);
    }
    return energy;
}

}  // namespace

TEST_CASE("the energy is the plain sum over domains, over several bricks and mixed laws") {
    for (const auto& n : {std::array{3, 2, 2},
                          std::array{37, 9, 2},
                          std::array{2, 9, 7},
                          std::array{2, 2, 9}}) {  // rows along x, y and z
        Block b = block(n);
        sim::Elasticity elasticity(b.lattice, b.body);
        const Field x =
            sum(corners_at(b.lattice), 1, random_field(b.lattice.n_corners(), 0.01, 1));
        Field gradient(x.size());
        const double expected = plain_energy(b, x);
        REQUIRE(expected > 1);
        CHECK(elasticity.energy_and_gradient(x.data(), gradient.data())
              == Approx(expected).epsilon(1e-12));
    }
}

TEST_CASE(
    "the gradient is the energy's derivative, K the gradient's, by observed order; K is "
    "symmetric") {
    // Rows along x, y and z.
    Block b = block(GENERATE(std::array{5, 3, 2}, std::array{2, 9, 4}, std::array{2, 3, 9}));
    sim::Elasticity elasticity(b.lattice, b.body);
    const int n = b.lattice.n_corners();
    const Field x = sum(corners_at(b.lattice), 1, random_field(n, 0.01, 2));
    const Field u = random_field(n, 1, 3), w = random_field(n, 1, 4);
    Field gradient(n), product(n), product_w(n);
    elasticity.energy_and_gradient(x.data(), gradient.data());
    elasticity.linearize(x.data(), false);
    elasticity.product(u.data(), product.data());
    elasticity.product(w.data(), product_w.data());
    REQUIRE(std::abs(dot(gradient, u)) > 1);
    CHECK(dot(product, w) == Approx(dot(product_w, u)).epsilon(1e-12));

    const auto errors = [&](double h) {
        Field g_plus(n), g_minus(n);
        const Field plus = sum(x, h, u), minus = sum(x, -h, u);
        const double difference =
            elasticity.energy_and_gradient(plus.data(), g_plus.data())
            - elasticity.energy_and_gradient(minus.data(), g_minus.data());
        return std::pair{
            std::abs(difference / (2 * h) - dot(gradient, u)),
            std::abs((dot(g_plus, w) - dot(g_minus, w)) / (2 * h) - dot(product, w))};
    };
    const auto [energy_coarse, gradient_coarse] = errors(2e-3);
    const auto [energy_fine, gradient_fine] = errors(1e-3);
    CHECK(std::log2(energy_coarse / energy_fine) == Approx(2).margin(0.1));
    CHECK(std::log2(gradient_coarse / gradient_fine) == Approx(2).margin(0.1));
}

TEST_CASE("two batches at a time give the gradient and energy of one by one, to the last bit") {
    // Rows of all lengths; and of bodies as small as batches, which hold several rows each.
    std::vector<assets::Shape> shapes{{assets::Box{{0, 0, 0}, {1.9, 0.7, 0.7}}},
                                      {assets::Sphere{{0.4, 0, 0}, 0.87}}};
    for (int n = 0; n < 64; ++n)
        shapes.push_back(
            {assets::Box{{0, 0, 0}, 0.1 * Vec3(1 + n % 4, 1 + n / 4 % 4, 1 + n / 16)}});
    const auto model = GENERATE(
        sim::Model::NeoHookean, sim::Model::StableNeoHookean, sim::Model::FixedCorotated);
    for (const assets::Shape& shape : shapes) {
        Block sample = block({1, 1, 1});
        sample.body.source.geometry = shape;
        sample.body.regions[0].model = model;
        sample.lattice = sim::make_lattice(sample.body);
        sim::Elasticity elasticity(sample.lattice, sample.body);
        const int n = sample.lattice.n_corners();
        const Field x = sum(corners_at(sample.lattice), 1, random_field(n, 0.01, 5));
        Field one(n), two(n);
        elasticity.takes_pairs = false;
        const double energy = elasticity.energy_and_gradient(x.data(), one.data());
        elasticity.takes_pairs = true;
        CHECK(elasticity.energy_and_gradient(x.data(), two.data()) == energy);
        CHECK(energy > 0);
        CHECK(std::memcmp(one.data(), two.data(), n * sizeof(Vec3p)) == 0);
    }
}

TEST_CASE("rigid motion costs nothing, and inner forces have no resultant and no moment") {
    Block b = block({4, 3, 3});
    sim::Elasticity elasticity(b.lattice, b.body);
    const Mat3 R = Eigen::AngleAxisd(1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    Field x;
    for (const Vec3& X : b.lattice.corner_rest)
        x.push_back(sim::padded(R * X + Vec3(3, -1, 2)));
    Field gradient(x.size());
    CHECK(std::abs(elasticity.energy_and_gradient(x.data(), gradient.data()))
          < 1e-12 * 1e5 * 0.036);

    x = sum(x, 1, random_field(static_cast<int>(x.size()), 0.01, 5));
    elasticity.energy_and_gradient(x.data(), gradient.data());
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    double scale = 0;
    for (std::size_t c = 0; c < x.size(); ++c) {
        force += sim::unpadded(gradient[c]);
        moment += sim::unpadded(x[c]).cross(sim::unpadded(gradient[c]));
        scale += sim::unpadded(gradient[c]).norm();
    }
    REQUIRE(scale > 100);
    CHECK(force.norm() < 1e-12 * scale);
    // The hourglass energy |F_g - F_p|² is invariant under rotation, so it exerts no moment either.
    CHECK(moment.norm() < 1e-12 * scale);
}

TEST_CASE("a domain bent along an axis stores the energy of a beam, E I curvature² s / 2") {
    Block b = block({1, 1, 1});
    const double curvature = 1e-4, s = b.lattice.edge, E = 1e5;
    Field x = corners_at(b.lattice);
    for (Vec3p& v : x)
        v[0] += curvature * (v[0] - s / 2) * (v[2] - s / 2);
    sim::Elasticity elasticity(b.lattice, b.body);
    Field gradient(x.size());
    const double beam = E * std::pow(s, 4) / 12 * curvature * curvature * s / 2;
    const double at_rest = 1e-15 * E * s * s * s;
    CHECK(elasticity.energy_and_gradient(x.data(), gradient.data())
          == Approx(beam).epsilon(1e-3).margin(at_rest));
}

TEST_CASE("an inverted domain of the log law is forbidden, and found") {
    Block b = block({1, 1, 1});
    Field x = corners_at(b.lattice);
    for (Vec3p& v : x)
        v[0] = -v[0];
    sim::Elasticity elasticity(b.lattice, b.body);
    Field gradient(x.size());
    CHECK(std::isinf(elasticity.energy_and_gradient(x.data(), gradient.data())));
    const auto smallest = elasticity.smallest_J(x.data());
    CHECK(smallest.J == Approx(-1));
    CHECK(smallest.domain == 0);
}

TEST_CASE("what is no number is the smallest J, whatever comes after it") {
    const Block b = block({12, 1, 1});
    Field x = corners_at(b.lattice);
    const int broken = 5;
    for (const int c : b.lattice.corners[broken])
        if (b.lattice.corner_rest[c].x() > 0.55)
            x[c][0] = std::numeric_limits<double>::quiet_NaN();
    for (const sim::Quadrature quadrature :
         {sim::Quadrature::OnePoint, sim::Quadrature::EightPoint}) {
        const auto smallest =
            sim::make_elastic_energy(b.lattice, b.body, quadrature)->smallest_J(x.data());
        CHECK(std::isnan(smallest.J));
        CHECK((smallest.domain == broken || smallest.domain == broken + 1));
    }
}
