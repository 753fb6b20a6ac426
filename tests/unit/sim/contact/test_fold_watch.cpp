#include "sim/contact/contact_search.h"
#include "sim/contact/fold_watch.h"
#include "sim/embedding/trilinear.h"
#include "tests/support/box_body.h"
#include "tests/support/random_fields.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using sim::Field;

namespace {

constexpr double edge = 0.05;

/// A block of domains, its corners wherever a test puts them.
struct Block {
    sim::Body body;
    sim::Lattice lattice;
    sim::ContactSurface surface;

    explicit Block(const std::array<int, 3>& n)
        : body(tests::box_body(n, edge)),
          lattice(sim::make_lattice(body)),
          surface(body, lattice, 0, 0) {}

    template <class Map>
    Field moved(const Map& map) const {
        Field x;
        for (const Vec3& X : lattice.corner_rest)
            x.push_back(sim::padded(map(X)));
        return x;
    }
};

bool is_in_tetrahedron(
    const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& x) {
    Mat3 edges;
    edges << b - a, c - a, d - a;
    const Vec3 w = edges.inverse() * (x - a);
    return w.minCoeff() >= 0 && w.sum() <= 1;
}

/// The vertices that are in one of six tetrahedra between the corners of a domain, a quarter continued, that is no
/// neighbour at rest: every vertex against every domain.
std::vector<int> strangers_by_brute_force(const sim::ContactSurface& surface, const Field& x) {
    std::vector<std::array<Vec3, 8>> hexahedra;
    for (const int p : surface.shell) {
        const auto corners = surface.domain_corners(p, x);
        std::array<Vec3, 8> continued;
        for (int a = 0; a < 8; ++a) {
            const auto w = sim::trilinear_weights(
                {a & 1 ? 1.25 : -0.25, a & 2 ? 1.25 : -0.25, a & 4 ? 1.25 : -0.25});
            continued[a].setZero();
            for (int b = 0; b < 8; ++b)
                continued[a] += w[b] * sim::unpadded(corners[b]);
        }
        hexahedra.push_back(continued);
    }
    std::vector<int> found;
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
        const Vec3 at = surface.vertices[v].position(x);
        const auto holds = [&](const std::array<Vec3, 8>& q) {
            // Around the diagonal from corner 0 to 7, by way of two more that an edge joins.
            constexpr std::array<int, 7> around{1, 3, 2, 6, 4, 5, 1};
            for (int k = 0; k < 6; ++k)
                if (is_in_tetrahedron(q[0], q[7], q[around[k]], q[around[k + 1]], at))
                    return true;
            return false;
        };
        for (std::size_t i = 0; i < hexahedra.size(); ++i)
            if ((surface.domain_centre(surface.shell[i]) - surface.vertices[v].rest).norm()
                    >= sim::neighbourhood * edge
                && holds(hexahedra[i])) {
                found.push_back(static_cast<int>(v));
                break;
            }
    }
    return found;
}

/// A strip along x bent by half a turn at its middle around an axis along y, `radius` from its mid-plane.
Vec3 hairpin(const Vec3& X, double length, double thickness, double radius) {
    const double bend = std::numbers::pi * radius;
    const double along = X.x() - (length - bend) / 2, out = radius + thickness / 2 - X.z();
    if (along < 0)
        return {along, X.y(), -out};
    if (along > bend)
        return {bend - along, X.y(), out};
    const double angle = along / radius;
    return {out * std::sin(angle), X.y(), -out * std::cos(angle)};
}

}  // namespace

TEST_CASE("a fold watch misses no vertex that brute force finds in a stranger") {
    const Block block({7, 6, 3});
    sim::FoldWatch watch(block.surface);
    tests::Random random(7);
    std::size_t n_found = 0;
    for (int shape = 0; shape < 6; ++shape) {
        // Waves of some domain edges crumple it, more and more, and back.
        const Vec3 amplitude = tests::random_vector(random, 2.5 * edge),
                   wave = tests::random_vector(random, 1.2 / edge),
                   phase = tests::random_vector(random, 3), way = tests::random_vector(random);
        for (int k = 0; k <= 6; ++k) {
            const double much = std::sin(std::numbers::pi * k / 6);
            const Field x = block.moved([&](const Vec3& X) -> Vec3 {
                const double arg = wave.dot(X);
                const Vec3 sway =
                    amplitude.cwiseProduct(Vec3((phase.array() + arg).sin().matrix()));
                return X + much * (sway + way);
            });
            const std::vector<int> strangers = watch.strangers(x),
                                   expected = strangers_by_brute_force(block.surface, x);
            CAPTURE(shape, k);
            CHECK(std::is_sorted(strangers.begin(), strangers.end()));
            CHECK(std::includes(
                strangers.begin(), strangers.end(), expected.begin(), expected.end()));
            // What it has seen before does not matter.
            CHECK(strangers == sim::FoldWatch(block.surface).strangers(x));
            n_found += expected.size();
        }
    }
    CHECK(n_found > 200);
}

TEST_CASE("a folded strip meets itself along its inner sides alone") {
    const int n = 24;
    const Block strip({n, 3, 1});
    sim::FoldWatch watch(strip.surface);
    // Closing step by step, so that what was seen before is used: from arms an edge apart to arms a fifth in each other.
    bool has_met = false;
    for (double gap = 1; gap > -0.2; gap -= 0.03) {
        const double radius = (1 + gap) / 2 * edge;
        const Field x =
            strip.moved([&](const Vec3& X) { return hairpin(X, n * edge, edge, radius); });
        const std::vector<int> strangers = watch.strangers(x),
                               expected = strangers_by_brute_force(strip.surface, x);
        CAPTURE(gap);
        CHECK(std::includes(
            strangers.begin(), strangers.end(), expected.begin(), expected.end()));
        if (gap > 0.5)
            CHECK(strangers.empty());
        for (const int v : strangers)
            CHECK(strip.surface.vertices[v].rest.z() > 0.4 * edge);
        has_met |= expected.size() > 100;
    }
    CHECK(has_met);
}

TEST_CASE(
    "arms that swell towards each other meet, though what is beyond them moves further than "
    "they") {
    const int n = 24;
    const Block strip({n, 3, 1});
    sim::FoldWatch watch(strip.surface);
    const double length = n * edge;
    // Only a little further apart than vertices are listed; the bend does not swell, nor do the arms' outer sides move.
    const double radius = 1.1 * edge;
    bool has_met = false;
    for (double swollen = 0; swollen < 0.5; swollen += 0.004) {
        const Field x = strip.moved([&](const Vec3& X) {
            const double from_end = std::min(X.x(), length - X.x());
            const double much = from_end < 8.5 * edge ? swollen : 0;
            return hairpin({X.x(), X.y(), (1 + much) * X.z()}, length, edge, radius);
        });
        const std::vector<int> strangers = watch.strangers(x);
        CAPTURE(swollen);
        CHECK(strangers == sim::FoldWatch(strip.surface).strangers(x));
        has_met |= strangers.size() > 50;
    }
    CHECK(has_met);
}

TEST_CASE("a strip that curls up meets its other end, far from it at first") {
    const int n = 30;
    const Block strip({n, 2, 1});
    sim::FoldWatch watch(strip.surface);
    bool has_met = false;
    int step = 0;
    for (double angle = 0.5; angle < 2 * std::numbers::pi + 0.8; angle += 0.05, ++step) {
        // It sways as well, so that all its blocks move, each in its own way.
        const double radius = n * edge / angle, sway = 0.1 * edge * std::sin(step);
        const Field x = strip.moved([&](const Vec3& X) -> Vec3 {
            const double at = X.x() / radius, out = radius - X.z();
            return {out * std::sin(at), X.y() + sway * std::sin(3 * at), -out * std::cos(at)};
        });
        const std::vector<int> strangers = watch.strangers(x);
        CAPTURE(angle);
        CHECK(strangers == sim::FoldWatch(strip.surface).strangers(x));
        if (angle < 1.7 * std::numbers::pi)
            CHECK(strangers.empty());
        if (step % 4 == 0) {
            const std::vector<int> expected = strangers_by_brute_force(strip.surface, x);
            CHECK(std::includes(
                strangers.begin(), strangers.end(), expected.begin(), expected.end()));
            has_met |= expected.size() > 50;
        }
    }
    CHECK(has_met);
}

TEST_CASE("a flap that folds over a body that swings is seen when it comes near") {
    // The body is stretched and pressed in small steps, its outer part turns over, into its own upper side.
    const Block block({12, 8, 3});
    sim::FoldWatch watch(block.surface);
    const double hinge = 5 * edge, bent = 2 * edge;
    std::size_t n_found = 0;
    for (int k = 1; k <= 121; ++k) {
        // Its upper side keeps its length.
        const double stretch = 1 + 0.3 * std::sin(0.15 * k), angle = 0.031 * k,
                     above = 3 * edge + bent / angle;
        const Field x = block.moved([&](const Vec3& X) -> Vec3 {
            const double along = X.x() - hinge, y = X.y() * stretch, down = above - X.z();
            if (along < 0)
                return {X.x(), y, X.z()};
            const double turned = std::min(along / bent, 1.0) * angle,
                         beyond = std::max(along - bent, 0.0);
            return {hinge + down * std::sin(turned) + beyond * std::cos(turned),
                    y,
                    above - down * std::cos(turned) + beyond * std::sin(turned)};
        });
        const std::vector<int> strangers = watch.strangers(x);
        CAPTURE(k);
        CHECK(strangers == sim::FoldWatch(block.surface).strangers(x));
        if (k % 12 == 1) {
            const std::vector<int> expected = strangers_by_brute_force(block.surface, x);
            CHECK(std::includes(
                strangers.begin(), strangers.end(), expected.begin(), expected.end()));
            n_found += expected.size();
        }
    }
    CHECK(n_found > 100);
}

TEST_CASE("a body that flies, turns, or is pressed flat is not folded") {
    const Block cube({8, 8, 8});
    sim::FoldWatch watch(cube.surface);
    for (int k = 0; k <= 20; ++k) {
        const Mat3 R = Eigen::AngleAxisd(0.4 * k, Vec3(1, 2, -1).normalized()).matrix();
        const double pressed = k / 20.0;
        CAPTURE(k);
        // Far, so that a body's own frame has to forget the place as well.
        CHECK(watch
                  .strangers(cube.moved(
                      [&](const Vec3& X) -> Vec3 { return R * X + 1e3 * k * Vec3(1, -2, 3); }))
                  .empty());
        // To 0.3 of its height, bulging half as much again.
        CHECK(watch
                  .strangers(cube.moved([&](const Vec3& X) -> Vec3 {
                      const Vec3 Y = X - Vec3::Constant(4 * edge);
                      const double bulge =
                          1 + 0.5 * pressed * (1 - std::pow(Y.z() / (4 * edge), 2));
                      return R
                             * Vec3(bulge * Y.x(), bulge * Y.y(), (1 - 0.7 * pressed) * Y.z());
                  }))
                  .empty());
    }
}
