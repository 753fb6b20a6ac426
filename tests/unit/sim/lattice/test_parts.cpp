// Parts that are thin, or not connected inside one cube.
#include "sim/embedding/embedding.h"
#include "sim/enrichment/enrichment.h"
#include "sim/lattice/voxels.h"
#include "tests/support/block_mesh.h"
#include "tests/unit/assets/generators/obj_file.h"
#include "tests/unit/sim/lattice/bodies.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>

using namespace sim;

namespace {

Body body_of(const ObjFile& file, double domain_size) {
    Body made = body(assets::Box{}, domain_size);
    made.source = file.source();
    return made;
}

double volume(const Lattice& lattice) {
    return std::accumulate(lattice.corner_volume.begin(), lattice.corner_volume.end(), 0.0);
}

/// Number of sets of domains that hang together by corners.
int components(const Lattice& lattice) {
    std::vector<int> root(lattice.n_corners());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int c) {
        while (root[c] != c)
            c = root[c] = root[root[c]];
        return c;
    };
    for (const auto& corners : lattice.corners)
        for (const int c : corners)
            root[find(c)] = find(corners[0]);
    int n = 0;
    for (int c = 0; c < lattice.n_corners(); ++c)
        n += find(c) == c;
    return n;
}

std::map<std::array<int, 3>, int> domains_per_cell(const Lattice& lattice) {
    std::map<std::array<int, 3>, int> n;
    for (const auto& cell : lattice.cell)
        ++n[cell];
    return n;
}

constexpr double s = 0.1;

}  // namespace

TEST_CASE("the prongs of a fork have domains of their own, joined where they meet") {
    const ObjFile file("supple_fork", tests::fork(s, 4));
    const Body fork = body_of(file, s);
    const Lattice lattice = make_lattice(fork);
    // Two cubes of the joint, four cubes with two prongs each.
    CHECK(lattice.n_domains() == 2 + 2 * 4);
    for (const auto& [cell, n] : domains_per_cell(lattice))
        CHECK(n == (cell[0] < 2 ? 1 : 2));
    // 3 planes of 4 corners of the joint; the prongs share the last of them, and have 4 more each.
    CHECK(lattice.n_corners() == 3 * 4 + 2 * 4 * 4);
    CHECK(components(lattice) == 1);
    // Trilinear samples of the level set round the fork's edges off.
    CHECK(volume(lattice) == Approx(s * s * s * (2 + 0.6 * 4)).epsilon(0.015));
    CHECK(std::is_sorted(
        lattice.corner_cell.begin(), lattice.corner_cell.end(), [](auto& a, auto& b) {
            return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
        }));
}

TEST_CASE("a fork of exact distances keeps its volume to 1e-3") {
    struct Fork : assets::Solid {
        Fork() {
            min = Vec3::Zero();
            max = s * Vec3(6, 1, 1);
        }

        double signed_distance(const Vec3& x) const override {
            const auto box = [&](const Vec3& low, const Vec3& high) {
                return assets::signed_distance(assets::Box{s * low, s * high}, x);
            };
            return std::min({box({0, 0, 0}, {2, 1, 1}),
                             box({0, 0, 0}, {6, 1, 0.3}),
                             box({0, 0, 0.7}, {6, 1, 1})});
        }
    };

    const Body made = body(assets::Box{{0, 0, 0}, {6 * s, s, s}}, s);
    LevelMaker maker(made);
    const RegionLayers regions(made, maker);
    const Fork solid;
    const std::vector<FilledCube> cubes = fill_cubes(place_grid(solid, made), solid, regions);
    CHECK(cubes.size() == 2 + 2 * 4);
    double filled = 0;
    for (const FilledCube& cube : cubes)
        filled += cube.filled;
    CHECK(filled / samples_per_cube == Approx(2 + 0.6 * 4).epsilon(1e-3));
}

TEST_CASE("points of a prong are bound to its own domains") {
    const ObjFile file("supple_fork_points", tests::fork(s, 4));
    const Lattice lattice = make_lattice(body_of(file, s));
    std::vector<Vec3> points;
    for (double x = 2.05; x < 6; x += 0.1)
        for (const double y : {0.0, 0.5, 1.0})
            for (const double z : {0.0, 0.15, 0.3, 0.7, 0.85, 1.0})
                points.push_back(s * Vec3(x, y, z));
    const std::vector<Binding> bindings = bind_points(lattice, points);
    // Prongs are told apart by moving the corners that the upper one alone has: those of its domains away from the joint.
    std::vector<Vec3> corners = lattice.corner_rest;
    for (int p = 0; p < lattice.n_domains(); ++p)
        if (lattice.cell[p][0] >= 2
            && squared_distance(
                   lattice, p, Vec3(lattice.cell[p][0], 0, 0) + Vec3(0.5, 0.5, 0.85))
                   == 0)
            for (const int c : lattice.corners[p])
                if (lattice.corner_cell[c][0] > 2)
                    corners[c] = lattice.corner_rest[c] + Vec3(0, 0, s);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double x = points[i].x() / s;
        const double rise = (carried(lattice, bindings[i], corners) - points[i]).z() / s;
        const double expected = points[i].z() < 0.5 * s ? 0 : std::min(1.0, x - 2);
        CHECK(rise == Approx(expected).margin(1e-12));
    }
}

TEST_CASE("of corners at one place those with material in the selected part are selected") {
    const ObjFile file("supple_fork_select", tests::fork(s, 4));
    const Body fork = body_of(file, s);
    const Lattice lattice = make_lattice(fork);
    const Selector upper_end = box(s * Vec3(4.9, -1, 0.5), s * Vec3(7, 2, 2));
    // The upper ends of two planes, of one prong.
    CHECK(select_corners(lattice, fork, upper_end).size() == 4);
    // A plane with no material in it selects the ends of both.
    CHECK(select_corners(lattice, fork, box(s * Vec3(6, -1, -1), s * Vec3(7, 2, 2))).size()
          == 8);
}

TEST_CASE("corners of a prong know the distance to their own part") {
    const ObjFile file("supple_fork_outside", tests::fork(s, 4));
    const Lattice lattice = make_lattice(body_of(file, s));
    int far = 0;
    for (int c = 0; c < lattice.n_corners(); ++c)
        if (lattice.corner_cell[c][0] > 2)
            far += lattice.corner_outside[c] > 0.6 * s;
    // Of the 8 corners at each of 4 planes half belong to the prong at the other side, 0.7 s away less a block.
    CHECK(far == 4 * 4);
}

TEST_CASE("regions of two prongs in one cube are no neighbours") {
    const ObjFile file("supple_fork_regions", tests::fork(s, 4));
    Body fork = body_of(file, s);
    fork.regions.push_back(
        region("upper", box(s * Vec3(1.999, -1, 0.5), s * Vec3(7, 2, 2)), 1e5));
    const Lattice lattice = make_lattice(fork);
    // The upper prong's first domain and the joint's last.
    CHECK(boundary_domains(lattice).size() == 2);
}

TEST_CASE("two legs thinner than a domain are joined at the top alone") {
    // Legs of 0.6 × 1 × 4 s at x = 0.2 and 1.2 s, under a bar across: side by side in neighbouring cubes.
    const ObjFile file(
        "supple_legs",
        tests::block_mesh({{{0.2 * s, 0.8 * s, 1.2 * s, 1.8 * s}, {0, s}, {0, 4 * s, 4.7 * s}}},
                          [](int i, int, int k) { return k == 1 || i != 1; }));
    const Lattice lattice = make_lattice(body_of(file, s));
    CHECK(components(lattice) == 1);
    CHECK(volume(lattice) == Approx(s * s * s * (2 * 0.6 * 4 + 1.6 * 0.7)).epsilon(0.01));
    // Away from the top, no domain of the one leg has a corner of the other.
    std::map<int, int> leg_of_corner;
    int glued = 0;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        if (lattice.cell[p][2] > 2)
            continue;
        const double middle = lattice.origin.x() + (lattice.cell[p][0] + 0.5) * s;
        const int leg = middle < s ? 1 : 2;
        for (const int c : lattice.corners[p])
            glued += leg_of_corner.try_emplace(c, leg).first->second != leg;
    }
    CHECK(glued == 0);
}

TEST_CASE("plates and fibres thinner than a domain keep their volume in one piece") {
    struct Case {
        const char* name;
        assets::Shape shape;
        assets::Transform transform;
        double volume;
    };

    const double pi = std::acos(-1.0);
    const assets::Transform still, turned{1, {0.4, 0.5, 0.6}, {0.03, 0.01, 0.02}};
    const assets::Box plate{{0, 0, 0}, {8 * s, 6 * s, 0.3 * s}};
    const assets::Box bar{{0, 0, 0}, {8 * s, 0.2 * s, 0.2 * s}};
    const assets::Capsule fibre{{0, 0, 0}, {8 * s, 0, 0}, 0.1 * s};
    const double of_fibre = pi * 0.01 * (8 + 4.0 / 3 * 0.1);
    for (const Case& made : {Case{"plate", plate, still, 14.4},
                             Case{"turned plate", plate, turned, 14.4},
                             Case{"square fibre", bar, still, 0.32},
                             Case{"turned square fibre", bar, turned, 0.32},
                             Case{"round fibre", fibre, still, of_fibre},
                             Case{"turned round fibre", fibre, turned, of_fibre}}) {
        INFO(made.name);
        Body thin = body(made.shape, s);
        thin.source.transform = made.transform;
        const Lattice lattice = make_lattice(thin);
        CHECK(components(lattice) == 1);
        CHECK(volume(lattice) == Approx(made.volume * s * s * s).epsilon(0.02));
    }
}

TEST_CASE("a meshed plate thinner than the level set's voxels keeps its volume") {
    const ObjFile file("supple_thin_plate",
                       tests::block_mesh({{{0, 4 * s}, {0, 4 * s}, {0, 0.3 * s}}},
                                         [](int, int, int) { return true; }));
    const Lattice lattice = make_lattice(body_of(file, s));
    CHECK(components(lattice) == 1);
    CHECK(volume(lattice) == Approx(4 * 4 * 0.3 * s * s * s).epsilon(0.02));
}

TEST_CASE("bodies thicker than a domain are sampled as ever, with one corner at a place") {
    for (const assets::Shape& shape :
         {assets::Shape(assets::Sphere{{0, 0, 0}, 0.33}),
          assets::Shape(assets::Box{{0, 0, 0}, {0.53, 0.42, 0.31}}),
          assets::Shape(assets::Torus{{0, 0, 0}, {1, 2, 3}, 0.4, 0.15})}) {
        const Lattice lattice = make_lattice(body(shape, s));
        CHECK(std::adjacent_find(lattice.corner_cell.begin(), lattice.corner_cell.end())
              == lattice.corner_cell.end());
        for (const double fill : lattice.fill)
            CHECK(fill * 512 == std::round(fill * 512));
    }
}
