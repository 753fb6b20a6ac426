#include "sim/materials/lanes.h"
#include "sim/materials/signed_svd.h"

#include <catch2/catch.hpp>

#include "samples.h"

using namespace samples;
using sim::GaussLanes;
using sim::lane_count;
using sim::Lanes;
using sim::Matrix3;

namespace {

struct alignas(sizeof(Lanes)) Batch {
    Matrix3<Lanes> F, P;
    Lanes mu, lambda, energy, A[sim::packed_size];
};

[[gnu::target_clones("arch=x86-64-v4", "default")]] void evaluate(sim::Model model,
                                                                  Batch& batch) {
    sim::visit(
        model, [&](auto law) __attribute__((always_inline)) {
            batch.energy = law.energy_and_first_piola(batch.F, batch.mu, batch.lambda, batch.P);
            law.stiffness(batch.F, batch.mu, batch.lambda, batch.A);
        });
}

Mat3 any_gradient(sim::Model model, int lane, Random& random) {
    Vec3 stretches(between(random, 0.4, 2), between(random, 0.4, 2), between(random, 0.4, 2));
    if (lane % 4 == 1)
        stretches[1] = stretches[0];
    if (lane % 4 == 2 && model != sim::Model::NeoHookean)
        stretches[2] *= -0.25;
    return stretched(stretches, random);
}

void check_lane(sim::Model model, const Batch& batch, int lane) {
    Matrix3<double> F, P;
    double A[sim::packed_size], energy = 0;
    for (int n = 0; n < 9; ++n)
        F.m[n] = batch.F.m[n][lane];
    sim::visit(model, [&](auto law) {
        energy = law.energy_and_first_piola(F, batch.mu[lane], batch.lambda[lane], P);
        law.stiffness(F, batch.mu[lane], batch.lambda[lane], A);
    });
    // Both round, but a compiler may fuse other products into sums; sums of a few terms of size A.
    const double scale = 1e-14 * Eigen::Map<Vec9>(A).norm();
    CHECK(std::abs(batch.energy[lane] - energy) <= scale);
    for (int n = 0; n < 9; ++n)
        CHECK(std::abs(batch.P.m[n][lane] - P.m[n]) <= scale);
    for (int n = 0; n < sim::packed_size; ++n)
        CHECK(std::abs(batch.A[n][lane] - A[n]) <= scale);
}

template <class S>
void set_lane(Matrix3<S>& A, int lane, const Mat3& value) {
    for (int n = 0; n < 9; ++n)
        A.m[n][lane] = value.data()[n];
}

template <class S>
Mat3 lane_of(const Matrix3<S>& A, int lane) {
    Mat3 result;
    for (int n = 0; n < 9; ++n)
        result.data()[n] = A.m[n][lane];
    return result;
}

double ulps_of_log(double found, double x) {
    const long double exact = std::log(static_cast<long double>(x));
    const double magnitude = std::abs(static_cast<double>(exact));
    const double ulp = std::nextafter(magnitude, 1e300) - magnitude;
    return static_cast<double>(std::abs(found - exact)) / ulp;
}

}  // namespace

TEST_CASE("every lane computes what a lone element does") {
    Random random(6);
    Batch batch;
    for (const sim::Model model : all_models) {
        for (int repeat = 0; repeat < 20; ++repeat) {
            for (int lane = 0; lane < lane_count; ++lane) {
                set_lane(batch.F, lane, any_gradient(model, lane, random));
                batch.mu[lane] = between(random, 1e3, 1e6);
                batch.lambda[lane] = between(random, 1e3, 1e6);
            }
            evaluate(model, batch);
            for (int lane = 0; lane < lane_count; ++lane)
                check_lane(model, batch, lane);
        }
    }
}

TEST_CASE("neo-Hookean: a collapsed lane leaves its neighbours alone") {
    Batch batch;
    for (int n = 0; n < 9; ++n)
        batch.F.m[n] = sim::uniform<Lanes>(n % 4 == 0 ? 1.1 : 0.0);
    batch.F.m[8][3] = -0.2;
    batch.mu = sim::uniform<Lanes>(mu);
    batch.lambda = sim::uniform<Lanes>(lambda);
    evaluate(sim::Model::NeoHookean, batch);
    for (int lane = 0; lane < lane_count; ++lane) {
        CHECK(std::isinf(batch.energy[lane]) == (lane == 3));
        CHECK(std::isnan(batch.P.m[0][lane]) == (lane == 3));
        CHECK(std::isnan(batch.A[0][lane]) == (lane == 3));
    }
}

TEMPLATE_TEST_CASE("nearest_rotation is that of the signed singular value decomposition",
                   "",
                   Lanes,
                   GaussLanes) {
    using S = TestType;
    constexpr int n_lanes = sizeof(S) / sizeof(double);
    Random random(12);
    int guessed = 0, mild = 0;
    for (int repeat = 0; repeat < 4000 / n_lanes; ++repeat) {
        Matrix3<S> F;
        bool is_mild[n_lanes];
        for (int lane = 0; lane < n_lanes; ++lane) {
            // From mild stretches, which the closed form takes, to flat and inverted elements; side by side.
            const int kind = (lane + repeat) % 8;
            is_mild[lane] = kind < 3;
            const double spread = kind < 4 ? std::log(2) : 5;
            Vec3 stretches;
            for (double& stretch : stretches)
                stretch = std::exp(between(random, -spread, spread));
            if (kind % 4 == 3)
                stretches[1] *= -0.2;
            if (kind == 5)
                stretches[2] = stretches[0];
            set_lane(F, lane, stretched(stretches, random));
        }
        const Matrix3<S> R = sim::nearest_rotation(F);
        const S trust = sim::nearest_rotation_guess(F).trust;
        for (int lane = 0; lane < n_lanes; ++lane) {
            const Mat3 f = lane_of(F, lane), r = lane_of(R, lane);
            const auto [U, sigma, V] = sim::signed_svd(f);
            // The rotation turns by δF/(σ_1 + σ_2) under an error δF, so rounding of F does that much.
            const double scale = 1 + sigma[0] / (sigma[1] + sigma[2]);
            CHECK((r - U * V.transpose()).norm() < 1e-14 * scale);
            CHECK((r - dense(sim::nearest_rotation(plain(f)))).norm() < 1e-14 * scale);
            CHECK((r.transpose() * r - Mat3::Identity()).norm() < 1e-14);
            CHECK(r.determinant() > 0);
            mild += is_mild[lane];
            guessed += is_mild[lane] && trust[lane] > 0;
        }
    }
    CHECK(mild == 3 * 500);
    CHECK(guessed == mild);
}

TEST_CASE("lanes in a std::vector stand where vector instructions can reach them") {
    for (std::size_t size = 1; size < 20; ++size) {
        const std::vector<Lanes> lanes(size);
        CHECK(reinterpret_cast<std::uintptr_t>(lanes.data()) % sizeof(Lanes) == 0);
    }
}

TEST_CASE("log_of is exact to one unit in the last place") {
    Random random(7);
    double worst = 0;
    for (int repeat = 0; repeat < 50000; ++repeat) {
        Lanes x;
        for (int lane = 0; lane < lane_count; ++lane) {
            const double spread = lane == 0  ? 700
                                  : lane < 3 ? 1
                                             : 1e-4;  // everywhere, near 1, nearer
            x[lane] = std::exp(between(random, -spread, spread));
        }
        const Lanes logarithms = sim::log_of(x);
        for (int lane = 0; lane < lane_count; ++lane)
            worst = std::max({worst,
                              ulps_of_log(logarithms[lane], x[lane]),
                              ulps_of_log(sim::log_of(x[lane]), x[lane])});
    }
    CHECK(worst < 1);
    CHECK(sim::log_of(1.0) == 0);
    CHECK(sim::log_of(std::numeric_limits<double>::min())
          == std::log(std::numeric_limits<double>::min()));
    CHECK(sim::log_of(std::numeric_limits<double>::max())
          == std::log(std::numeric_limits<double>::max()));
}

TEST_CASE("select_positive takes the first where x > 0, zero of either sign excluded") {
    const GaussLanes x = {1, -1, 0.0, -0.0, 1e-320, -1e-320, 1e308, -1e308};
    const GaussLanes chosen =
        sim::select_positive(x, sim::uniform<GaussLanes>(7), sim::uniform<GaussLanes>(5));
    for (int lane = 0; lane < 8; ++lane) {
        CHECK(chosen[lane] == (x[lane] > 0 ? 7 : 5));
        CHECK(sim::select_positive(x[lane], 7.0, 5.0) == chosen[lane]);
    }
}
