#include "sim/contact/contact_search.h"
#include "sim/contact/domain_hull.h"
#include "sim/contact/near_domain_lists.h"
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

/// A ball, whose vertices lie outside of its domains in part, a block, and a plate that the block stands on, a little in it.
/// Each turned, stretched and moved by itself.
struct Three {
    sim::Body ball = tests::body_of(assets::Sphere{{0, 0, 0}, 2.3 * edge}, edge),
              block = tests::box_body({5, 4, 3}, edge),
              plate = tests::box_body({6, 4, 2}, edge, edge*Vec3(-0.7, 0.2, -1.9));
    sim::Lattice of_ball = sim::make_lattice(ball), of_block = sim::make_lattice(block),
                 of_plate = sim::make_lattice(plate);
    std::vector<sim::ContactSurface> surfaces{
        {ball, of_ball, 0, 0},
        {block, of_block, of_ball.n_corners(), 1},
        {plate, of_plate, of_ball.n_corners() + of_block.n_corners(), 2}};

    /// The block and the plate stay together.
    Field at(const Vec3& of_first, const Vec3& of_second, double angle, double sway) const {
        const Mat3 R = Eigen::AngleAxisd(angle, Vec3(1, 2, 2) / 3).matrix();
        const auto swung = [&](const Vec3& X) -> Vec3 {
            return X + sway * edge * (Vec3(X.y(), X.z(), X.x()) / edge).array().sin().matrix();
        };
        Field x;
        for (const Vec3& X : of_ball.corner_rest)
            x.push_back(sim::padded(R * swung(X) + of_first));
        for (const sim::Lattice* lattice : {&of_block, &of_plate})
            for (const Vec3& X : lattice->corner_rest)
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
                     const Field& x,
                     double share) {
    Pairs pairs;
    for (const int p : b.shell) {
        const std::array<Vec3p, 8> corners = b.domain_corners(p, x);
        const Vec3 centre = place(corners, Vec3::Zero());
        double radius = 0;
        for (int c = 0; c < 8; ++c)
            radius = std::max(
                radius, (place(corners, (1 + 2 * share) * corner_of_cube(c)) - centre).norm());
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
    const Three three;
    tests::Random random(3);
    for (int k = 0; k < 5; ++k) {
        Field x = three.at({2 * edge, 2 * edge, 4.6 * edge}, {0, 0, 0}, 0.3 * k, 0);
        for (Vec3p& at : x)
            at += sim::padded(tests::random_vector(random, 0.25 * edge));
        const auto near = sim::near_domains(three.surfaces[0],
                                            three.surfaces[0].all_vertices(),
                                            three.surfaces[1],
                                            x,
                                            beyond,
                                            0);
        CHECK(listed(near) == by_brute_force(three.surfaces[0], three.surfaces[1], x, beyond));
        CHECK(near.vertices.size() > 20);
    }
}

TEST_CASE("lists of near domains miss none while bodies pass each other at any speed") {
    const Three three;
    sim::NearDomainLists lists(three.surfaces);
    const double step = GENERATE(0.012, 0.02, 1.1) * edge;
    std::size_t n_pairs = 0, n_contacts = 0, n_rolling = 0, n_more = 0;
    for (double way = -8 * edge; way < 8 * edge; way += step) {
        // All fly as well, each swings, and the ball rolls over the block's top, pressed into it.
        const Vec3 flight(20 * way, -3 * way, way);
        const double sway = 0.15 * std::sin(way / edge);
        const Field x = three.at(flight + Vec3(2.5 * edge + way, 2 * edge, 4.6 * edge),
                                 flight,
                                 0.2 * way / edge,
                                 sway);
        const double now_beyond = (1 + 0.5 * std::sin(3 * way / edge)) * beyond,
                     margin = now_beyond * edge;
        for (const auto& [a, b] :
             {std::pair(0, 1), std::pair(1, 0), std::pair(1, 2), std::pair(2, 0)}) {
            CAPTURE(way / edge, a, b);
            const sim::ContactSurface &of_a = three.surfaces[a], &of_b = three.surfaces[b];
            const Pairs expected = by_brute_force(of_a, of_b, x, now_beyond);
            const sim::NearDomains& near = lists.near(a, b, x, now_beyond);
            const Pairs pairs = listed(near);
            CHECK(std::includes(pairs.begin(), pairs.end(), expected.begin(), expected.end()));
            CHECK(std::is_sorted(near.vertices.begin(), near.vertices.end()));
            CHECK(std::is_sorted(near.domains.begin(), near.domains.end()));
            // What is listed besides changes nothing.
            const auto found = sim::find_listed_contacts(of_a, near, of_b, x, x, margin);
            const std::vector<int> all = of_a.all_vertices();
            CHECK(are_equal(found, sim::find_contacts(of_a, all, of_b, x, x, margin)));
            n_pairs += expected.size();
            n_rolling += a + b == 1 ? expected.size() : 0;
            n_more += a + b == 1 ? pairs.size() - expected.size() : 0;
            n_contacts += found.size();
        }
    }
    CHECK(n_pairs > 500);
    CHECK(n_contacts > 50);
    // Of fast ones little is listed ahead.
    CHECK((n_more > n_rolling / 10) == (step < edge));
}

TEST_CASE("a domain that swells to a vertex is listed in time") {
    // The block's corner lies on the diagonal of the domain, as far from its centre as its ball reaches swollen by a quarter.
    const sim::Body block = tests::box_body({2, 2, 2}, edge, Vec3::Constant(1.424 * edge)),
                    single = tests::box_body({1, 1, 1}, edge);
    const sim::Lattice of_block = sim::make_lattice(block),
                       of_single = sim::make_lattice(single);
    const std::vector<sim::ContactSurface> bodies{{block, of_block, 0, 0},
                                                  {single, of_single, of_block.n_corners(), 1}};
    sim::NearDomainLists lists(bodies);
    const Vec3 centre = Vec3::Constant(edge / 2);
    std::size_t n_expected = 0;
    for (double swollen = 1; swollen < 1.4; swollen += 0.01) {
        Field x;
        for (const Vec3& X : of_block.corner_rest)
            x.push_back(sim::padded(X));
        for (const Vec3& X : of_single.corner_rest)
            x.push_back(sim::padded(centre + swollen * (X - centre)));
        const Pairs expected = by_brute_force(bodies[0], bodies[1], x, beyond),
                    pairs = listed(lists.near(0, 1, x, beyond));
        CHECK(std::includes(pairs.begin(), pairs.end(), expected.begin(), expected.end()));
        CHECK((expected.empty() || swollen > 1.2));
        n_expected += expected.size();
    }
    CHECK(n_expected > 0);
}

TEST_CASE("a fast body leaves lists of others made ahead") {
    const Three three;
    sim::NearDomainLists lists(three.surfaces);
    for (int k = 0; k < 6; ++k) {
        const Field x = three.at({0, k * edge, 4.6 * edge}, {0, 0, 0}, 0, 0);
        lists.near(0, 1, x, beyond);
        const Pairs at_rest = listed(lists.near(1, 2, x, beyond));
        CHECK(at_rest.size()
              > by_brute_force(three.surfaces[1], three.surfaces[2], x, beyond).size());
    }
}

TEST_CASE("domains that no vertex is near are not listed") {
    const Three three;
    sim::NearDomainLists lists(three.surfaces);
    const double above = GENERATE(4.6, 20.0);
    const Field x = three.at({2 * edge, 2 * edge, above * edge}, {0, 0, 0}, 0, 0);
    const sim::NearDomains& near = lists.near(0, 1, x, beyond);
    CHECK(near.vertices.empty() == (above > 10));
    for (std::size_t i = 0; i < near.domains.size(); ++i)
        CHECK(std::ranges::count(near.nearby, static_cast<int>(i)) > 0);
    CHECK(near.domains.empty() == near.vertices.empty());
}
