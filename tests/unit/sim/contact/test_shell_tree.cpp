#include "sim/contact/domain_hull.h"
#include "sim/contact/own_frame.h"
#include "sim/contact/shell_tree.h"
#include "tests/support/box_body.h"
#include "tests/support/random_fields.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <algorithm>
#include <utility>
#include <vector>

using sim::Field;
using sim::Vec3p;

namespace {

constexpr double edge = 0.05;

}  // namespace

TEST_CASE("a tree of a shell finds the strangers near domains that loops over both find") {
    const sim::Body body = tests::box_body({9, 4, 3}, edge);
    const sim::Lattice lattice = sim::make_lattice(body);
    const int begin = 5;
    const sim::ContactSurface surface(body, lattice, begin, 0);
    const double beyond = 0.25, apart = 2.5 * edge;
    sim::ShellTree tree(surface, beyond, apart);

    tests::Random random(3);
    std::size_t n_found = 0;
    for (const double pressed : {1.0, 0.5, 0.25}) {
        Field corners;
        for (const Vec3& X : lattice.corner_rest)
            corners.push_back(sim::padded(Vec3(pressed * X.x(), X.y(), X.z())
                                          + tests::random_vector(random, 0.2 * edge)));
        Field all(begin);
        all.insert(all.end(), corners.begin(), corners.end());
        for (const double within : {0.0, 0.6 * edge}) {
            std::vector<std::pair<int, int>> found, expected;
            tree.place(corners, within);
            for (int group = 0; group < tree.n_groups(); ++group)
                tree.for_strangers(group, [&](int v, const Vec3p& x, int q) {
                    found.emplace_back(v, q);
                    // Sums in another order.
                    CHECK((sim::unpadded(x) - surface.vertices[v].position(all)).norm()
                          <= 1e-14);
                });
            for (const int q : surface.shell) {
                std::array<Vec3p, 8> continued = surface.domain_corners(q, all);
                sim::go_beyond(beyond, continued);
                sim::PaddedBounds box;
                for (const Vec3p& corner : continued)
                    box.add(corner);
                for (const int v : surface.all_vertices())
                    if ((surface.vertices[v].rest - surface.domain_centre(q)).norm() >= apart
                        && box.widened(within).holds(surface.vertices[v].padded_position(all)))
                        expected.emplace_back(v, q);
            }
            std::sort(found.begin(), found.end());
            std::sort(expected.begin(), expected.end());
            CAPTURE(pressed, within);
            CHECK(found == expected);
            n_found += found.size();
        }
    }
    CHECK(n_found > 1000);
}

TEST_CASE("a hull's gap is that along the axis or diagonal that parts a point most") {
    tests::Random random(5);
    std::array<Vec3p, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] =
            sim::padded(Vec3(a & 1, a >> 1 & 1, a >> 2) + tests::random_vector(random, 0.2));
    const sim::Hull hull(corners);
    for (int repeat = 0; repeat < 100; ++repeat) {
        const Vec3 x = Vec3::Constant(0.5) + tests::random_vector(random, 2);
        double most = -10;
        for (int i = -1; i <= 1; ++i)
            for (int j = -1; j <= 1; ++j)
                for (int k = -1; k <= 1; ++k) {
                    if (i == 0 && j == 0 && k == 0)
                        continue;
                    const Vec3 n = Vec3(i, j, k).normalized();
                    double highest = -10;
                    for (const Vec3p& corner : corners)
                        highest = std::max(highest, n.dot(sim::unpadded(corner)));
                    most = std::max(most, n.dot(x) - highest);
                }
        CHECK(hull.gap(sim::padded(x)) == Approx(most).margin(1e-14));
    }
}

TEST_CASE("a frame of its own follows a body that flies and turns") {
    tests::Random random(6);
    Field rest;
    Vec3p mean{};
    for (int c = 0; c < 20; ++c) {
        rest.push_back(sim::padded(tests::random_vector(random)));
        mean += rest.back() / 20.0;
    }
    const auto frame_at = [&](double angle) {
        const Mat3 R = Eigen::AngleAxisd(angle, Vec3(1, 2, -2) / 3).matrix();
        sim::FrameSums sums;
        Field x;
        for (const Vec3p& X : rest) {
            x.push_back(sim::padded(Vec3(3, 4, 5) + R * sim::unpadded(X)));
            sums.add(x.back(), X - mean);
        }
        const sim::OwnFrame frame = sums.frame(rest.size());
        for (std::size_t c = 0; c < rest.size(); ++c) {
            const Vec3p missed = frame.seen(x[c]) - (rest[c] - mean);
            CHECK(std::sqrt(sim::dot(missed, missed)) <= 1e-13);
        }
        return frame;
    };
    const sim::OwnFrame before = frame_at(0.3);
    for (const double angle : {0.0, 0.3, 0.8, 2.5})
        CHECK(frame_at(angle).turn_from(before)
              == Approx(2 * std::abs(std::sin((angle - 0.3) / 2))).margin(1e-13));
}
