#include <catch2/catch.hpp>

#include "samples.h"

using namespace samples;
using sim::Model;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Ψ of the principal stretches, as in the literature.
double energy_of_stretches(Model model, const Vec3& l) {
    const double J = l.prod(), a = mu / (lambda + mu);
    switch (model) {
        case Model::NeoHookean:
            return mu / 2 * (l.squaredNorm() - 3) - mu * std::log(J)
                   + lambda / 2 * std::pow(std::log(J), 2);
        case Model::StableNeoHookean:
            return mu / 2 * (l.squaredNorm() - 3) + (lambda + mu) / 2 * std::pow(J - 1 - a, 2)
                   - mu * mu / (2 * (lambda + mu));
        case Model::FixedCorotated:
        case Model::Snow:  // between two yields
            return mu * (l - Vec3::Ones()).squaredNorm() + lambda / 2 * std::pow(J - 1, 2);
    }
    return 0;
}

/// The stretch across the load at which the sides are free, by bisection.
template <class SideStress>
double free_stretch(const SideStress& stress) {
    double low = 0.3, high = 2;
    REQUIRE(stress(low) < 0);
    REQUIRE(stress(high) > 0);
    while (high - low > 1e-14)
        (stress((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
    return (low + high) / 2;
}

Mat3 diagonal(double x, double y, double z) {
    return Vec3(x, y, z).asDiagonal();
}

struct Uniaxial {
    double stretch, lateral, P11_kPa;
};

void check_uniaxial(Model model, const std::vector<Uniaxial>& states) {
    for (const auto& [stretch, lateral, P11_kPa] : states) {
        CAPTURE(stretch);
        const double l = stretch;
        const double t = free_stretch(
            [&](double side) { return first_piola(model, diagonal(l, side, side))(1, 1); });
        CHECK(t == Approx(lateral).margin(0.5e-4));  // half a unit of the last printed digit
        CHECK(first_piola(model, diagonal(l, t, t))(0, 0) / 1e3
              == Approx(P11_kPa).margin(0.05));
    }
}

}  // namespace

TEST_CASE("the energy density is that of the principal stretches") {
    Random random(3);
    for (const Model model : all_models) {
        for (const Vec3& l : stretch_samples()) {
            const double expected = energy_of_stretches(model, l);
            CHECK(energy_density(model, stretched(l, random))
                  == Approx(expected).epsilon(1e-13).margin(1e-14 * mu));
        }
    }
    for (const Model model : {Model::StableNeoHookean, Model::FixedCorotated}) {
        const Vec3 l(1.2, 0.9, -0.3);
        CHECK(energy_density(model, stretched(l, random))
              == Approx(energy_of_stretches(model, l)).epsilon(1e-13));
    }
}

TEST_CASE("rest, turned or not, has neither energy nor stress") {
    Random random(4);
    for (const Model model : all_models) {
        CHECK(energy_density(model, Mat3::Identity()) == 0);
        CHECK(first_piola(model, Mat3::Identity()).norm() == 0);
        const Mat3 R = rotation(random);
        CHECK(std::abs(energy_density(model, R)) < 1e-14 * mu);  // a dozen roundings of μ
        CHECK(first_piola(model, R).norm() < 1e-14 * mu);
    }
}

TEST_CASE("a rotation turns the stress and keeps the energy") {
    Random random(5);
    for (const Model model : all_models) {
        const Mat3 F = stretched({1.4, 1.1, 0.7}, random), R = rotation(random);
        CHECK(energy_density(model, R * F) == Approx(energy_density(model, F)).epsilon(1e-13));
        const Mat3 P = first_piola(model, F);
        CHECK((first_piola(model, R * F) - R * P).norm() < 1e-13 * P.norm());
        CHECK((first_piola(model, F * R) - P * R).norm() < 1e-13 * P.norm());
    }
}

TEST_CASE("neo-Hookean: a collapsed element has infinite energy and no stress") {
    for (const double volume : {0.0, -1e-300, -0.5, 1e-310}) {
        CAPTURE(volume);
        const Mat3 F = diagonal(1, volume, 1);
        CHECK(energy_density(Model::NeoHookean, F) == infinity);
        CHECK(first_piola(Model::NeoHookean, F).array().isNaN().all());
        CHECK(stiffness(Model::NeoHookean, F).diagonal().array().isNaN().all());
    }
    CHECK(std::isfinite(energy_density(Model::NeoHookean, diagonal(1, 1e-300, 1))));
}

TEST_CASE("an element that is not a number has no finite energy") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Model model : all_models) {
        CHECK_FALSE(std::isfinite(energy_density(model, diagonal(1, nan, 1))));
        CHECK_FALSE(std::isfinite(energy_density(model, diagonal(1, infinity, 1))));
    }
}

TEST_CASE("uniaxial stress with free sides") {  // E = 1 MPa, ν = 0.3, solved independently
    check_uniaxial(Model::NeoHookean,
                   {{0.5, 1.2108, -935.4},
                    {0.7, 1.1079, -405.2},
                    {1.5, 0.8802, 378.3},
                    {2, 0.7981, 646.7}});
    check_uniaxial(Model::FixedCorotated,
                   {{0.5, 1.1471, -644.3},
                    {0.7, 1.0935, -343.2},
                    {1.5, 0.8693, 442.9},
                    {2, 0.7732, 836.7}});
}

TEST_CASE("neo-Hookean: equibiaxial and confined stress, and shear") {
    const Model model = Model::NeoHookean;
    const double thickness =
        free_stretch([&](double t) { return first_piola(model, diagonal(1.5, 1.5, t))(2, 2); });
    CHECK(thickness == Approx(0.65202).margin(0.5e-5));
    CHECK(first_piola(model, diagonal(1.5, 1.5, thickness))(0, 0) / 1e3
          == Approx(467.9).margin(0.05));

    CHECK(first_piola(model, diagonal(0.5, 1, 1))(0, 0) / 1e3 == Approx(-1376.7).margin(0.05));

    Mat3 shear = Mat3::Identity();
    shear(0, 1) = 0.5;
    const Mat3 cauchy = first_piola(model, shear) * shear.transpose();  // J = 1
    CHECK(cauchy(0, 1) / 1e3 == Approx(192.31).margin(0.005));
    CHECK(cauchy(0, 0) / 1e3 == Approx(96.15).margin(0.005));
}
