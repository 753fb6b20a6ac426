#include "sim/contact/contact_search.h"
#include "tests/support/box_body.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

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
