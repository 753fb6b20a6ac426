#include "sim/grid/corner_map.h"
#include "sim/lattice/lattice.h"
#include "tests/support/box_body.h"
#include "tests/support/corner_fields.h"
#include "tests/support/random_fields.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

using sim::CornerMap;
using sim::Field;
using sim::Kernel;
using sim::Vec3p;

namespace {

constexpr double s = 0.1;

CornerMap map_of(
    const sim::Lattice& lattice, const Field& x, double h, Kernel kernel, bool cuts) {
    CornerMap map;
    map.rebuild(x,
                std::vector<char>(x.size(), 0),
                {{0, lattice.n_corners(), h, kernel, cuts ? &lattice.corners : nullptr}});
    return map;
}

/// Two blocks n domains high of which a gap as wide as a domain keeps the upper parts apart, over a base of `base` domains.
sim::Lattice two_legs(int base, int n) {
    sim::Body body = tests::box_body({3, 1, base + n}, s);
    sim::Lattice lattice = sim::make_lattice(body);
    std::vector<std::array<int, 8>> kept;
    for (int p = 0; p < lattice.n_domains(); ++p)
        if (lattice.cell[p][2] < base || lattice.cell[p][0] != 1)
            kept.push_back(lattice.corners[p]);
    lattice.corners = kept;
    return lattice;
}

std::set<int> nodes_at(const CornerMap& map, int corner) {
    std::vector<CornerMap::Weight> row;
    map.find_row(corner, row);
    std::set<int> nodes;
    for (const auto& [dof, weight] : row)
        nodes.insert(dof);
    return nodes;
}

}  // namespace

TEST_CASE("where domains connect all, nodes are those of a grid that is not cut") {
    const sim::Lattice lattice = sim::make_lattice(tests::box_body({6, 5, 4}, s));
    const double h = GENERATE(0.05, 0.1, 0.13, 0.2, 0.9);
    const Kernel kernel = GENERATE(Kernel::Linear, Kernel::Quadratic, Kernel::Cubic);
    // On nodes, a rounding beside them, and anywhere; torn as if it had been deformed.
    const Vec3 shift =
        GENERATE(Vec3(0, 0, 0), Vec3(1e-17, -1e-16, 1e-16), Vec3(-7.77, 0.031, 3.003));
    const double noise = GENERATE(0.0, 0.03);
    tests::Random random(3);
    Field x = tests::corners_at(lattice, Mat3::Identity(), shift);
    for (Vec3p& corner : x)
        corner += sim::padded(tests::random_vector(random, noise));
    const CornerMap cut = map_of(lattice, x, h, kernel, true),
                    whole = map_of(lattice, x, h, kernel, false);
    CAPTURE(h, int(kernel), shift.transpose(), noise);
    // Where cells are smaller than domains, corners alone in theirs may have nodes that no domain connects.
    if (h >= 2 * s && noise == 0)
        CHECK(cut.n_dofs() == whole.n_dofs());
    Field u(x.size()), v(x.size());
    const Vec3 slope(0.3, -1, 2);
    const auto linear = [&](const CornerMap& map, Field& at_corners) {
        Field at_nodes;
        for (const Vec3p& node : map.dof_position())
            at_nodes.push_back(sim::padded(Vec3::Constant(slope.dot(sim::unpadded(node)))));
        map.apply(at_nodes, at_corners);
    };
    linear(cut, u);
    linear(whole, v);
    double worst = 0;
    for (std::size_t c = 0; c < x.size(); ++c)
        for (const Field* at : {&u, &v})
            worst = std::max(worst, std::abs((*at)[c][0] - slope.dot(sim::unpadded(x[c]))));
    CHECK(worst < 1e-13);
}

TEST_CASE("legs that stand in one cell do not share its nodes") {
    const sim::Lattice lattice = two_legs(0, 6);
    const Field x = tests::corners_at(lattice, Mat3::Identity(), Vec3(0, 0, 0));
    const CornerMap map = map_of(lattice, x, 8 * s, Kernel::Linear, true);
    std::set<int> left, right;
    for (const std::array<int, 8>& corners : lattice.corners)
        for (const int c : corners) {
            const std::set<int> nodes = nodes_at(map, c);
            (x[c][0] < 1.5 * s ? left : right).insert(nodes.begin(), nodes.end());
        }
    for (const int node : left)
        CHECK(right.count(node) == 0);
    CHECK(map.n_dofs() > int(left.size() + right.size()) - 1);
    CHECK(map_of(lattice, x, 8 * s, Kernel::Linear, false).n_dofs() == int(left.size()));
}

TEST_CASE("legs share the nodes around what connects them, and no others") {
    const sim::Lattice lattice = two_legs(1, 11);
    const double h = 4 * s;
    const Field x = tests::corners_at(lattice, Mat3::Identity(), Vec3(0.01, 0.01, 0.01));
    const CornerMap map = map_of(lattice, x, h, Kernel::Linear, true);
    const auto meets = [&](double z) {
        std::set<int> left, right;
        for (const std::array<int, 8>& corners : lattice.corners)
            for (const int c : corners) {
                if (std::abs(lattice.corner_rest[c].z() - lattice.corner_rest[0].z() - z)
                    > 1e-9)
                    continue;
                const std::set<int> nodes = nodes_at(map, c);
                (x[c][0] < 1.5 * s ? left : right).insert(nodes.begin(), nodes.end());
            }
        REQUIRE((!left.empty() && !right.empty()));
        int n = 0;
        for (const int node : left)
            n += right.count(node);
        return n;
    };
    CHECK(meets(s) > 0);
    CHECK(meets(3 * s) > 0);   // in the cell of the base
    CHECK(meets(6 * s) > 0);   // at its upper nodes
    CHECK(meets(9 * s) == 0);  // two cells above
}
