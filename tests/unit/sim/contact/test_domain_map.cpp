#include "sim/contact/domain_map.h"
#include "sim/embedding/trilinear.h"
#include "tests/support/random_fields.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using sim::Vec3p;

namespace {

constexpr double edge = 0.05;
const Vec3 far_off(7, -3, 2);

/// A cube that is stretched and turned a little, its corners out of place by up to `much` edges.
std::array<Vec3, 8> bent_cube(tests::Random& random, double much) {
    const Mat3 F =
        Mat3::Identity() + tests::random_vector(random, 0.2) * Vec3(1, -1, 1).transpose();
    std::array<Vec3, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] =
            far_off
            + edge * (F * Vec3(a & 1, a >> 1 & 1, a >> 2) + tests::random_vector(random, much));
    return corners;
}

sim::DomainMap map_of(const std::array<Vec3, 8>& corners) {
    std::array<Vec3p, 8> padded;
    std::ranges::transform(corners, padded.begin(), sim::padded);
    return sim::DomainMap(padded);
}

Vec3 place(const std::array<Vec3, 8>& corners, const Vec3& u) {
    const auto w = sim::trilinear_weights(u + Vec3::Constant(0.5));
    Vec3 sum = Vec3::Zero();
    for (int a = 0; a < 8; ++a)
        sum += w[a] * corners[a];
    return sum;
}

}  // namespace

TEST_CASE("a domain's map and gradient are those of trilinear weights, and are inverted") {
    tests::Random random(1);
    for (int k = 0; k < 200; ++k) {
        const std::array<Vec3, 8> corners = bent_cube(random, 0.15);
        const sim::DomainMap map = map_of(corners);
        const Vec3 u = tests::random_vector(random, 0.75), v = tests::random_vector(random);
        const Vec3 x = place(corners, u);
        CAPTURE(u.transpose());
        CHECK((sim::unpadded(map.at(sim::padded(u))) - x).norm() < 1e-14 * far_off.norm());

        const Mat3 expected = sim::trilinear_gradient(u + Vec3::Constant(0.5), 1, corners);
        const sim::PaddedMatrix gradient = map.gradient(sim::padded(u));
        CHECK(gradient.determinant == Approx(expected.determinant()));
        CHECK((expected * sim::unpadded(gradient.solve(sim::padded(v))) - v).norm() < 1e-12);
        CHECK((expected.transpose() * sim::unpadded(gradient.solve_transposed(sim::padded(v)))
               - v)
                  .norm()
              < 1e-12);

        Vec3p found{};
        REQUIRE(map.invert(sim::padded(x), found));
        CHECK((sim::unpadded(found) - u).norm() < 1e-12);
    }
}

TEST_CASE("the linear part of a domain's map errs by no more than its bend") {
    tests::Random random(2);
    double largest_share = 0;
    for (int k = 0; k < 200; ++k) {
        const double most = k % 2 == 0 ? 0.5 : 0.75;
        const std::array<Vec3, 8> corners = bent_cube(random, 0.1);
        const sim::DomainMap map = map_of(corners);
        const sim::PaddedMatrix at_centre = map.gradient_at_centre();
        const double bend = map.bend(at_centre, most);
        for (int corner = 0; corner < 8; ++corner)  // where what is bilinear is largest
            for (const double share : {1.0, 0.7}) {
                const Vec3 u =
                    share * most
                    * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
                const Vec3p linear =
                    at_centre.solve(sim::padded(place(corners, u)) - map.centre());
                const double error = (sim::unpadded(linear) - u).cwiseAbs().maxCoeff();
                CHECK(error <= bend * (1 + 1e-9));
                largest_share = std::max(largest_share, error / bend);
            }
    }
    CHECK(largest_share > 0.9);
    const sim::DomainMap parallelepiped = map_of(bent_cube(random, 0));
    CHECK(parallelepiped.bend(parallelepiped.gradient_at_centre(), 1) < 1e-12);
}

TEST_CASE("an inverted domain, and a point that is far off a bent one, are not inverted") {
    std::array<Vec3, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] = edge * Vec3(a & 1, a >> 1 & 1, -(a >> 2));
    Vec3p u{};
    CHECK_FALSE(map_of(corners).invert(sim::padded(Vec3::Constant(edge / 3)), u));
    tests::Random random(3);
    for (int k = 0; k < 50; ++k) {
        u = Vec3p{};
        const Vec3 off = far_off + 9 * tests::random_vector(random).normalized();
        CHECK_FALSE(map_of(bent_cube(random, 0.15)).invert(sim::padded(off), u));
    }
}

TEST_CASE("what is said to be inverted is, even of a domain with a corner pushed through") {
    tests::Random random(4);
    int n_inverted = 0, n_not = 0;
    for (int k = 0; k < 2000; ++k) {
        std::array<Vec3, 8> corners = bent_cube(random, 0.15);
        corners[7] += tests::between(random, 0.6, 1.2) * (corners[0] - corners[7]);
        const sim::DomainMap map = map_of(corners);
        const Vec3 x = place(corners, tests::random_vector(random, 0.75));
        Vec3p u{};
        const bool is_inverted = map.invert(sim::padded(x), u);
        if (is_inverted)
            CHECK((sim::unpadded(map.at(u)) - x).norm() < 1e-11 * edge);
        ++(is_inverted ? n_inverted : n_not);
    }
    CHECK(n_inverted > 200);
    CHECK(n_not > 200);
}
