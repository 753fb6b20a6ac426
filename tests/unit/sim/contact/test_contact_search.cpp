#include "sim/contact/contact_search.h"
#include "sim/embedding/trilinear.h"
#include "tests/support/box_body.h"
#include "tests/support/random_fields.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

using sim::Field;

namespace {

constexpr double edge = 0.05, margin = 0.25 * edge;

/// A body that lends vertices, and one whose inside they are looked for in, as they are at rest but turned and moved.
struct Two {
    sim::Body first, second;
    sim::Lattice of_first, of_second;
    sim::ContactSurface vertices, domains;
    Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, -1, 2).normalized()).matrix();
    Vec3 t{3, -1, 2};
    Field x;

    Two(const assets::Shape& lends, const assets::Shape& holds)
        : first(tests::body_of(lends, edge)),
          second(tests::body_of(holds, edge)),
          of_first(sim::make_lattice(first)),
          of_second(sim::make_lattice(second)),
          vertices(first, of_first, 0, 0),
          domains(second, of_second, of_first.n_corners(), 1) {
        for (const sim::Lattice* lattice : {&of_first, &of_second})
            for (const Vec3& X : lattice->corner_rest)
                x.push_back(sim::padded(R * X + t));
    }

    std::vector<sim::ContactPoint> found() const {
        return sim::find_contacts(vertices, vertices.all_vertices(), domains, x, x, margin);
    }
};

}  // namespace

TEST_CASE(
    "vertices in a box have its depth, its normal, and a point of it at their own place") {
    // A slab of one domain's height, a fifth of it in the top of a box, well inside its sides.
    const double depth = 0.2 * edge, top = 4 * edge;
    const Two two(assets::Box{{1.2 * edge, 1.2 * edge, top - depth},
                              {2.8 * edge, 2.8 * edge, top + edge}},
                  assets::Box{{0, 0, 0}, {4 * edge, 4 * edge, top}});
    std::set<const sim::ContactVertex*> seen;
    for (const sim::ContactPoint& contact : two.found()) {
        const Vec3 rest = contact.vertex->rest;
        CAPTURE(rest.transpose());
        // Distances are interpolated between voxels, exactly where the surface is flat.
        CHECK(contact.gap == Approx(rest.z() - top).margin(1e-3 * edge));
        CHECK((contact.normal - two.R.col(2)).norm() < 1e-3);
        CHECK(contact.separation(two.x).norm() < 1e-9);
        double sum = 0;
        for (const double w : contact.weights)
            sum += w;
        CHECK(sum == Approx(1));
        if (rest.z() < top)  // in one of the domains of the top that holds it
            for (int a = 0; a < 8; ++a)
                CHECK((contact.weights[a] > -1e-9 && contact.weights[a] < 1 + 1e-9));
        seen.insert(contact.vertex);
    }
    // All of them, and none further out than the margin.
    std::size_t n_expected = 0;
    for (const sim::ContactVertex& vertex : two.vertices.vertices) {
        const double gap = vertex.rest.z() - top;
        if (std::abs(gap - margin) < 0.01 * edge)
            continue;
        n_expected += gap < margin;
        CHECK((seen.count(&vertex) == 1) == (gap < margin));
    }
    CHECK(n_expected >= 16);
    CHECK(sim::find_contacts(two.vertices, {}, two.domains, two.x, two.x, margin).empty());
}

TEST_CASE("vertices near a ball have their distance from it and the radial normal") {
    const assets::Sphere ball{{0, 0, 0}, 4 * edge};
    const Two two(assets::Box{{-edge, -edge, 3.85 * edge}, {edge, edge, 5 * edge}}, ball);
    const auto found = two.found();
    CHECK(found.size() >= 16);
    for (const sim::ContactPoint& contact : found) {
        const Vec3 rest = contact.vertex->rest;
        CAPTURE(rest.transpose());
        // Between voxels of a third of a domain a ball's distance bends by (edge/3)² / (8 R) = 0.0035 edges, its slope by
        // a sixth of an edge over R.
        CHECK(contact.gap == Approx(rest.norm() - ball.radius).margin(0.01 * edge));
        CHECK((contact.normal - two.R * rest.normalized()).norm() < 0.05);
    }
}

namespace {

double outside_of_cube(const Vec3& xi) {
    return std::max(0.0, (xi - Vec3::Constant(0.5)).cwiseAbs().maxCoeff() - 0.5);
}

/// How far a point is outside of the nearest domain of a bent body, in its edges, by Newton's method in every one.
double outside_by_brute_force(const sim::ContactSurface& body,
                              const Field& x,
                              const Vec3& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const int p : body.shell) {
        std::array<Vec3, 8> corners;
        std::ranges::transform(body.domain_corners(p, x), corners.begin(), sim::unpadded);
        Vec3 xi = Vec3::Constant(0.5), miss = Vec3::Ones();
        for (int k = 0; k < 30 && xi.cwiseAbs().maxCoeff() < 4; ++k) {
            const auto w = sim::trilinear_weights(xi);
            miss = point;
            for (int a = 0; a < 8; ++a)
                miss -= w[a] * corners[a];
            xi += sim::trilinear_gradient(xi, 1, corners).inverse() * miss;
        }
        // A map is not continued into another domain.
        std::array<int, 3> cell = body.lattice->cell[p];
        for (int k = 0; k < 3; ++k)
            cell[k] += static_cast<int>(std::floor(xi[k]));
        const double outside = outside_of_cube(xi);
        if (miss.norm() < 1e-12 && (outside < 1e-3 || body.cells.find(cell) < 0))
            least = std::min(least, outside);
    }
    return least;
}

}  // namespace

TEST_CASE("of bent bodies every vertex is found in the nearest domain that brute force finds") {
    Two two(assets::Sphere{{2 * edge, 2 * edge, 5.2 * edge}, 2.4 * edge},
            assets::Box{{0, 0, 0}, {5 * edge, 4 * edge, 3 * edge}});
    tests::Random random(4);
    const Field straight = two.x;
    std::size_t n_found = 0;
    for (const double much : {0.0, 0.05, 0.12, 0.18}) {
        two.x = straight;
        for (sim::Vec3p& at : two.x)
            at += sim::padded(tests::random_vector(random, much * edge));
        std::map<const sim::ContactVertex*, double> outside_of_found;
        for (const sim::ContactPoint& contact : two.found()) {
            outside_of_found[contact.vertex] =
                outside_of_cube(sim::local_coordinates(contact.weights));
            CHECK(contact.separation(two.x).norm() < 1e-9 * edge);
        }
        n_found += outside_of_found.size();
        for (const sim::ContactVertex& vertex : two.vertices.vertices) {
            const double outside =
                outside_by_brute_force(two.domains, two.x, vertex.position(two.x));
            const auto found = outside_of_found.find(&vertex);
            CAPTURE(much, vertex.rest.transpose(), outside);
            if (found != outside_of_found.end())
                CHECK(found->second == Approx(outside).margin(1e-9));
            // One beside a domain may still be further from the surface than the margin.
            if (outside < 0.8 * margin / edge)
                CHECK(found != outside_of_found.end());
        }
    }
    CHECK(n_found > 100);
}
