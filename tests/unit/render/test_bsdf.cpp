#include "render/pathtrace/bsdf.h"
#include "render/pathtrace/warp.h"

#include <catch2/catch.hpp>

using namespace render;

namespace {

Vec3f direction(float cosine, float phi) {
    const float sine = std::sqrt(1 - cosine * cosine);
    return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

// Midpoint rule over the upper or the whole sphere: an integral that owes nothing to sample().
template <class Function>
double integral(const Function& f, bool whole_sphere) {
    constexpr int n_cosines = 600, n_angles = 360;
    double sum = 0;
    for (int i = 0; i < n_cosines; ++i)
        for (int j = 0; j < n_angles; ++j) {
            const float s = (float(i) + 0.5f) / n_cosines;
            const float cosine = whole_sphere ? 2 * s - 1 : s;
            sum += f(direction(cosine, 2 * pi * (float(j) + 0.5f) / n_angles));
        }
    return sum * 2 * M_PI * (whole_sphere ? 2 : 1) / (n_cosines * n_angles);
}

}  // namespace

TEST_CASE("a white coated body reflects all light, for every roughness and angle") {
    for (const float roughness : {0.3f, 0.6f, 1.0f})
        for (const float cosine : {0.1f, 0.5f, 0.95f}) {
            CAPTURE(roughness, cosine);
            const Coat coat(roughness);
            const Bsdf bsdf(Vec3f::Ones(), 1, &coat, direction(cosine, 0));
            const double reflected =
                integral([&](const Vec3f& wi) { return bsdf.evaluate(wi).x(); }, false);
            CHECK(reflected == Approx(1).margin(0.01));  // tabulated albedo, midpoint rule
        }
}

TEST_CASE("the coat and the coated base are reciprocal") {
    const Coat coat(0.4f);
    const Vec3f a = direction(0.3f, 0.2f), b = direction(0.8f, 2.5f);
    const Vec3f color(0.3f, 0.5f, 0.7f);
    const Vec3f ab = Bsdf(color, 1, &coat, a).evaluate(b) / b.z();
    const Vec3f ba = Bsdf(color, 1, &coat, b).evaluate(a) / a.z();
    CHECK((ab - ba).norm() < 1e-5f * ab.norm());
}

TEST_CASE("densities integrate to the share of directions that scatter") {
    const Coat coat(0.5f);
    for (const float cosine : {0.2f, 0.9f}) {
        const Vec3f wo = direction(cosine, 1);
        CAPTURE(cosine);
        // What the coat sends below the surface is missing: little at this roughness, and never more than all.
        const Bsdf opaque(Vec3f::Constant(0.5f), 1, &coat, wo);
        const double up = integral([&](const Vec3f& wi) { return opaque.pdf(wi); }, false);
        CHECK(up <= 1.002);
        CHECK(up > 0.9);
        const Bsdf bare(Vec3f::Constant(0.5f), 1, nullptr, wo);
        CHECK(integral([&](const Vec3f& wi) { return bare.pdf(wi); }, false)
              == Approx(1).margin(2e-3));
    }
}

TEST_CASE("sampled directions follow the density") {
    // Mean of weight · g(wi) must be ∫ f g: g picks a slice of directions.
    const Coat coat(0.35f);
    const Vec3f wo = direction(0.6f, 0);
    for (const float opacity : {1.0f, 0.4f}) {
        const Bsdf bsdf(Vec3f::Constant(0.7f), opacity, &coat, wo);
        for (const float level : {-0.5f, 0.5f, 0.8f}) {
            const auto slice = [&](const Vec3f& wi) {
                return level < 0 ? wi.z() < level : wi.z() > level;
            };
            const double expected = integral(
                [&](const Vec3f& wi) { return slice(wi) ? bsdf.evaluate(wi).x() : 0.0f; },
                true);
            constexpr int n = 1 << 14;
            double sum = 0, sum_squares = 0;
            for (std::uint32_t i = 0; i < n; ++i) {
                const BsdfSample s = bsdf.sample(owen_sobol(i, 5).x, owen_sobol(i, 9));
                const double value = !s.straight && slice(s.direction) ? s.weight.x() : 0;
                sum += value, sum_squares += value * value;
            }
            const double mean = sum / n, sigma = std::sqrt((sum_squares / n - mean * mean) / n);
            CAPTURE(opacity, level, mean, sigma);
            CHECK(std::abs(mean - expected)
                  <= 4 * sigma + 2e-3 * expected);  // and the midpoint rule's error
        }
    }
}

TEST_CASE("a clear skin that absorbs nothing loses nothing") {
    const Coat coat(0.4f);
    const Bsdf bsdf(Vec3f::Ones(), 0.3f, &coat, direction(0.7f, 0));
    const double scattered =
        integral([&](const Vec3f& wi) { return bsdf.evaluate(wi).x(); }, true);
    CHECK(scattered + skin_transmittance(0.3f, &coat, 0.7f) == Approx(1).margin(0.01));
}

TEST_CASE("a clear skin follows Beer's law of its slanted path") {
    CHECK(skin_share(0.3f, 1) == Approx(0.3));
    CHECK(1 - skin_share(0.3f, 0.5f) == Approx(0.7 * 0.7));  // twice the way at 60 degrees
    CHECK(skin_share(1, 0.4f) == 1);
}
