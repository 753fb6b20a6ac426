#include "sim/contact/contact_search.h"
#include "sim/contact/domain_hull.h"
#include "sim/contact/near_domains.h"
#include "sim/embedding/trilinear.h"
#include "tests/support/box_body.h"
#include "tests/support/random_fields.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

using sim::Field;
using sim::Vec3p;

// What is listed must not show: all is compared with every vertex against every domain.

namespace {

constexpr double edge = 0.05, beyond = 0.25;

/// A ball, whose vertices lie outside of its domains in part, and a block; each turned, stretched and moved by itself.
struct Two {
    sim::Body ball = tests::body_of(assets::Sphere{{0, 0, 0}, 2.3 * edge}, edge),
              block = tests::box_body({5, 4, 3}, edge);
    sim::Lattice of_ball = sim::make_lattice(ball), of_block = sim::make_lattice(block);
    std::vector<sim::ContactSurface> surfaces{{ball, of_ball, 0, 0},
                                              {block, of_block, of_ball.n_corners(), 1}};

    Field at(const Vec3& of_first, const Vec3& of_second, double angle, double sway) const {
        const Mat3 R = Eigen::AngleAxisd(angle, Vec3(1, 2, 2) / 3).matrix();
        const auto swung = [&](const Vec3& X) -> Vec3 {
            return X + sway * edge * (Vec3(X.y(), X.z(), X.x()) / edge).array().sin().matrix();
        };
        Field x;
        for (const Vec3& X : of_ball.corner_rest)
            x.push_back(sim::padded(R * swung(X) + of_first));
        for (const Vec3& X : of_block.corner_rest)
            x.push_back(sim::padded(swung(X) + of_second));
        return x;
    }
};

using Pairs = std::set<std::pair<int, int>>;

Pairs listed(const sim::NearDomains& near) {
    Pairs pairs;
    for (std::size_t k = 0; k < near.vertices.size(); ++k)
        for (const int i : near.of_vertex(k))
            pairs.emplace(near.vertices[k], near.domains[i]);
    return pairs;
}

/// What the map of a domain gives at u, its centre being the origin and its edge 1.   [m]
Vec3 place(const std::array<Vec3p, 8>& corners, const Vec3& u) {
    const auto w = sim::trilinear_weights(u + Vec3::Constant(0.5));
    Vec3 sum = Vec3::Zero();
    for (int a = 0; a < 8; ++a)
        sum += w[a] * sim::unpadded(corners[a]);
    return sum;
}

Vec3 corner_of_cube(int a) {
    return Vec3(a & 1, a >> 1 & 1, a >> 2) - Vec3::Constant(0.5);
}

/// No further from the centre of a domain than the furthest corner of what it is continued to.
Pairs by_brute_force(const sim::ContactSurface& a,
                     const sim::ContactSurface& b,
                     const Field& x) {
    Pairs pairs;
    for (const int p : b.shell) {
        const std::array<Vec3p, 8> corners = b.domain_corners(p, x);
        const Vec3 centre = place(corners, Vec3::Zero());
        double radius = 0;
        for (int c = 0; c < 8; ++c)
            radius = std::max(
                radius, (place(corners, (1 + 2 * beyond) * corner_of_cube(c)) - centre).norm());
        for (std::size_t v = 0; v < a.vertices.size(); ++v)
            if ((a.vertices[v].position(x) - centre).norm() < radius * (1 - 1e-12))
                pairs.emplace(static_cast<int>(v), p);
    }
    return pairs;
}

bool are_equal(const std::vector<sim::ContactPoint>& a,
               const std::vector<sim::ContactPoint>& b) {
    return std::equal(
        a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
            return one.vertex == other.vertex && one.gap == other.gap
                   && one.normal == other.normal && one.corners == other.corners
                   && one.weights == other.weights;
        });
}

}  // namespace

TEST_CASE("a ball holds all that the map of a bent domain is continued to") {
    tests::Random random(2);
    for (int k = 0; k < 100; ++k) {
        std::array<Vec3p, 8> corners;
        for (int a = 0; a < 8; ++a)
            corners[a] = sim::padded(corner_of_cube(a) + tests::random_vector(random, 0.2));
        std::array<Vec3p, 8> continued = corners;
        sim::go_beyond(beyond, continued);
        sim::Ball ball(continued);
        ball.squared_radius *= 1 + 1e-12;
        double furthest = 0;
        for (int a = 0; a < 8; ++a)
            for (const double share : {1.0, 0.9}) {
                const Vec3 u = share * (1 + 2 * beyond) * corner_of_cube(a);
                const Vec3p x = sim::padded(place(corners, u));
                CHECK(ball.holds(x));
                furthest = std::max(furthest, sim::dot(x - ball.centre, x - ball.centre));
            }
        CHECK(furthest == Approx(ball.squared_radius));
    }
}

TEST_CASE("of bent bodies those domains are listed whose balls hold a vertex") {
    const Two two;
    tests::Random random(3);
    for (int k = 0; k < 5; ++k) {
        Field x = two.at({2 * edge, 2 * edge, 4.6 * edge}, {0, 0, 0}, 0.3 * k, 0);
        for (Vec3p& at : x)
            at += sim::padded(tests::random_vector(random, 0.25 * edge));
        const auto near = sim::near_domains(
            two.surfaces[0], two.surfaces[0].all_vertices(), two.surfaces[1], x, beyond, 0);
        CHECK(listed(near) == by_brute_force(two.surfaces[0], two.surfaces[1], x));
        CHECK(near.vertices.size() > 20);
    }
}

TEST_CASE("lists of near domains miss none while bodies pass each other at any speed") {
    const Two two;
    sim::NearDomainLists lists(two.surfaces);
    const double step = GENERATE(0.004, 0.02, 1.1) * edge;
    std::size_t n_pairs = 0, n_contacts = 0, n_more = 0;
    for (double way = -9 * edge; way < 9 * edge;
         way += std::max(step, 0.2 * step + 0.01 * edge)) {
        // Both fly as well, each swings, and the ball rolls over the block's top, pressed into it.
        const Vec3 flight(20 * way, -3 * way, way);
        const double sway = 0.15 * std::sin(way / edge);
        const Field x = two.at(flight + Vec3(2.5 * edge + way, 2 * edge, 4.6 * edge),
                               flight,
                               0.2 * way / edge,
                               sway);
        lists.see();
        for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 0)}) {
            CAPTURE(way / edge, a);
            const Pairs expected = by_brute_force(two.surfaces[a], two.surfaces[b], x);
            const sim::NearDomains& near = lists.near(a, b, x, beyond);
            const Pairs pairs = listed(near);
            CHECK(std::includes(pairs.begin(), pairs.end(), expected.begin(), expected.end()));
            CHECK(std::is_sorted(near.vertices.begin(), near.vertices.end()));
            CHECK(std::is_sorted(near.domains.begin(), near.domains.end()));
            // What is listed besides changes nothing.
            const double margin = beyond * edge;
            const auto found =
                sim::find_listed_contacts(two.surfaces[a], near, two.surfaces[b], x, x, margin);
            CHECK(are_equal(found,
                            sim::find_contacts(two.surfaces[a],
                                               two.surfaces[a].all_vertices(),
                                               two.surfaces[b],
                                               x,
                                               x,
                                               margin)));
            n_pairs += expected.size();
            n_more += pairs.size() - expected.size();
            n_contacts += found.size();
        }
    }
    CHECK(n_pairs > 500);
    CHECK(n_contacts > 50);
    CHECK((n_more > 0) == (step < edge));  // fast ones are listed anew
}

TEST_CASE("balls that hold no vertex are not listed") {
    const Two two;
    const Field x = two.at({0, 0, 20 * edge}, {0, 0, 0}, 0, 0);
    sim::NearDomainLists lists(two.surfaces);
    lists.see();
    CHECK(lists.near(0, 1, x, beyond).vertices.empty());
    CHECK(lists.near(0, 1, x, beyond).domains.empty());
}
