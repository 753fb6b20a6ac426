#include "assets/base/error.h"
#include "sim/grid/corner_map.h"
#include "tests/support/random_fields.h"
#include "tests/support/threads.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include <cstring>
#include <set>

using sim::CornerMap;
using sim::Field;
using sim::Vec3p;

namespace {

struct Sample {
    Field corners;
    std::vector<char> free;
    std::vector<CornerMap::BodyRange> bodies;
    CornerMap map;

    int n_corners() const { return static_cast<int>(corners.size()); }
};

/// Two bodies in the same place with different cells: scattered corners, corners on planes, edges and nodes of the
/// grid, and a quarter of the corners free. `offset` in cells of the first body.
Sample sample(const Vec3& offset, double share_free = 0.25) {
    tests::Random random(7);
    const double h[2] = {0.05, 0.04};
    Sample s;
    for (int b = 0; b < 2; ++b) {
        const int begin = s.n_corners();
        for (int k = 0; k < 60; ++k)
            s.corners.push_back(
                sim::padded(h[b] * offset + tests::random_vector(random, 2 * h[0])));
        for (int k = 0; k < 27;
             ++k)  // halves of the cell: nodes, edge middles, face and cell centres
            s.corners.push_back(
                sim::padded(h[b] * (offset + Vec3(k % 3, k / 3 % 3, k / 9) / 2)));
        s.bodies.push_back({begin, s.n_corners(), h[b]});
    }
    for (int c = 0; c < s.n_corners(); ++c)
        s.free.push_back(tests::between(random, 0, 1) < share_free);
    s.map.rebuild(s.corners, s.free, s.bodies);
    return s;
}

const std::vector<Vec3> offsets = {{0, 0, 0}, {-3.25, 0.5, -1}, {1e4, -2e4, 1e3 + 0.3}};

/// T as a dense matrix (#C × #dofs): T acts on each component alike.
Eigen::MatrixXd dense(const Sample& s) {
    Eigen::MatrixXd T(s.n_corners(), s.map.n_dofs());
    Field q(s.map.n_dofs()), u(s.n_corners());
    for (int i = 0; i < s.map.n_dofs(); ++i) {
        q[i] = Vec3p{1, 1, 1, 0};
        s.map.apply(q, u);
        q[i] = Vec3p{};
        for (int c = 0; c < s.n_corners(); ++c) {
            REQUIRE((u[c][0] == u[c][1] && u[c][1] == u[c][2] && u[c][3] == 0));
            T(c, i) = u[c][0];
        }
    }
    return T;
}

/// Π (1 - |x - node| / h) where positive.
double hat(const Vec3p& x, const Vec3p& node, double h) {
    return (Vec3::Ones() - sim::unpadded(x - node).cwiseAbs() / h).cwiseMax(0).prod();
}

}  // namespace

TEST_CASE("T has unit rows at free corners and hat functions of grid nodes at the others") {
    for (const Vec3& offset : offsets) {
        CAPTURE(offset.transpose());
        const Sample s = sample(offset);
        const Eigen::MatrixXd T = dense(s);
        REQUIRE(s.map.n_free() > 20);
        for (int c = 0; c < s.n_corners(); ++c) {
            const int b = c >= s.bodies[1].begin;
            REQUIRE((s.map.dof_of_corner()[c] >= 0) == bool(s.free[c]));
            if (s.free[c]) {
                CHECK(s.map.free_corner()[s.map.dof_of_corner()[c]] == c);
                CHECK(T.row(c).transpose()
                      == Eigen::VectorXd::Unit(s.map.n_dofs(), s.map.dof_of_corner()[c]));
                continue;
            }
            const double rounding = 1e-15 * (1 + offset.norm());
            for (int i = 0; i < s.map.n_dofs(); ++i) {
                const bool is_node_of_body = i >= s.map.n_free() && s.map.dof_body()[i] == b;
                const double expected =
                    is_node_of_body
                        ? hat(s.corners[c], s.map.dof_position()[i], s.bodies[b].cell_size)
                        : 0;
                REQUIRE(std::abs(T(c, i) - expected) <= 10 * rounding);
            }
        }
    }
}

TEST_CASE("a row of T asked for by itself is the one that T is made of, for every kernel") {
    Sample s = sample(offsets[1]);
    s.bodies[0].kernel = GENERATE(sim::Kernel::Linear, sim::Kernel::Quadratic);
    s.bodies[1].kernel = sim::Kernel::Cubic;
    s.map.rebuild(s.corners, s.free, s.bodies);
    const Eigen::MatrixXd T = dense(s);
    std::vector<CornerMap::Weight> weights;
    for (int c = 0; c < s.n_corners(); ++c) {
        s.map.find_row(c, weights);
        Eigen::VectorXd row = Eigen::VectorXd::Zero(s.map.n_dofs());
        for (const auto& [dof, weight] : weights)
            row[dof] += weight;
        CHECK((row - T.row(c).transpose()).cwiseAbs().maxCoeff() < 1e-15);
        CHECK(row.sum() == Approx(1));
    }
}

TEST_CASE("bodies share no node, and no node is numbered twice") {
    const Sample s = sample(offsets[1]);
    const Eigen::MatrixXd T = dense(s);
    const int half = s.bodies[1].begin;
    std::set<std::array<long, 4>> nodes;
    for (int i = 0; i < s.map.n_dofs(); ++i) {
        const bool acts_on_first = T.col(i).head(half).any(),
                   acts_on_second = T.col(i).tail(half).any();
        CHECK(!(acts_on_first && acts_on_second));
        const int b = s.map.dof_body()[i];
        CHECK(!(b == 0 ? acts_on_second : acts_on_first));
        if (i < s.map.n_free())
            continue;
        const Vec3 k = sim::unpadded(s.map.dof_position()[i]) / s.bodies[b].cell_size;
        CHECK((k - Vec3(k.array().round())).norm() <= 1e-12);
        CHECK(nodes.insert({b, std::lround(k.x()), std::lround(k.y()), std::lround(k.z())})
                  .second);
    }
}

TEST_CASE("T reproduces affine fields") {
    tests::Random random(3);
    const Mat3 A = Mat3::NullaryExpr([&] { return tests::between(random, -1, 1); });
    const Vec3 b(0.3, -2, 1);
    for (const Vec3& offset : offsets) {
        CAPTURE(offset.transpose());
        const Sample s = sample(offset);
        Field q(s.map.n_dofs()), u(s.n_corners());
        for (int i = 0; i < s.map.n_dofs(); ++i)
            q[i] = sim::padded(A * sim::unpadded(s.map.dof_position()[i]) + b);
        s.map.apply(q, u);
        for (int c = 0; c < s.n_corners(); ++c) {
            const Vec3 x = sim::unpadded(s.corners[c]);
            REQUIRE((sim::unpadded(u[c]) - (A * x + b)).norm()
                    <= 1e-15 * 20 * (x.norm() + b.norm()));
        }
    }
}

TEST_CASE("corners move by what T gives them, wherever they come from") {
    tests::Random random(5);
    const double dt = 0.25;
    for (const Vec3& offset : offsets) {
        CAPTURE(offset.transpose());
        const Sample s = sample(offset);
        Field q(s.map.n_dofs()), u(s.n_corners()), x;
        for (Vec3p& value : q)
            value = sim::padded(tests::random_vector(random));
        s.map.apply(q, u);
        s.map.move(s.corners, dt, q, x);
        REQUIRE(x.size() == s.corners.size());
        for (int c = 0; c < s.n_corners(); ++c)
            REQUIRE(sim::unpadded(x[c] - (s.corners[c] + dt * u[c])).norm()
                    <= 1e-15 * (2 + offset.norm()));
    }
}

TEST_CASE("bodies that are moved by themselves move as all do together") {
    tests::Random random(6);
    const double dt = 0.25;
    const Sample s = sample(offsets[1]);
    const Field q = tests::random_field(s.map.n_dofs(), random);
    Field x, u(s.n_corners());
    s.map.move(s.corners, dt, q, x);
    s.map.apply(q, u);
    for (const std::vector<int>& moving : {std::vector{0}, {1}, {0, 1}}) {
        Field expected = s.corners, expected_u(s.n_corners());
        for (const int b : moving)
            for (int c = s.bodies[b].begin; c < s.bodies[b].end; ++c) {
                expected[c] = x[c];
                expected_u[c] = u[c];
            }
        Field moved = s.corners, with_u = s.corners, moved_u(s.n_corners());
        s.map.move_bodies(moving, s.corners, dt, q, moved);
        s.map.move_bodies(moving, s.corners, dt, q, with_u, &moved_u);
        CHECK(tests::largest_difference(moved, expected) <= 1e-14);
        CHECK(tests::largest_difference(with_u, expected) <= 1e-14);
        CHECK(tests::largest_difference(moved_u, expected_u) <= 1e-14);
    }
}

TEST_CASE("T at a few corners is that at all, and leaves the others alone") {
    tests::Random random(23);
    Sample s = sample(offsets[1]);
    s.bodies[0].kernel = GENERATE(sim::Kernel::Linear, sim::Kernel::Quadratic);
    s.bodies[1].kernel = sim::Kernel::Cubic;
    s.map.rebuild(s.corners, s.free, s.bodies);
    const Field q = tests::random_field(s.map.n_dofs(), random),
                before = tests::random_field(s.n_corners(), random);
    Field all(s.n_corners()), set = before, added = before;
    s.map.apply(q, all);
    std::vector<int> corners;
    for (int c = s.n_corners() - 1; c >= 0; c -= 3)
        corners.push_back(c);
    s.map.apply_at(corners, q, set);
    s.map.add_applied_at(corners, q, added);
    Field expected_set = before, expected_added = before;
    for (const int c : corners) {
        expected_set[c] = all[c];
        expected_added[c] = before[c] + all[c];
    }
    CHECK(tests::largest_difference(set, expected_set) <= 1e-15);
    CHECK(tests::largest_difference(added, expected_added) <= 1e-15);
}

TEST_CASE("the gathers are the transposes of T and of its squares") {
    tests::Random random(11);
    const Sample s = sample(offsets[1]);
    const Eigen::MatrixXd T = dense(s);
    const Field q = tests::random_field(s.map.n_dofs(), random),
                f = tests::random_field(s.n_corners(), random);
    Field u(s.n_corners()), Tt_f(s.map.n_dofs()), squares(s.map.n_dofs());
    s.map.apply(q, u);
    s.map.apply_transposed(f, Tt_f);
    CHECK(tests::dot(u, f) == Approx(tests::dot(q, Tt_f)).epsilon(1e-13));
    s.map.apply_squared_transposed(f, squares);
    for (int axis = 0; axis < 3; ++axis) {
        Eigen::VectorXd column(s.n_corners());
        for (int c = 0; c < s.n_corners(); ++c)
            column[c] = f[c][axis];
        const Eigen::VectorXd expected = T.cwiseProduct(T).transpose() * column;
        for (int i = 0; i < s.map.n_dofs(); ++i)
            CHECK(squares[i][axis] == Approx(expected[i]).margin(1e-14));
    }
}

TEST_CASE(
    "the nodes of a body gather from its slaves alone, and differences as what is gathered "
    "differs") {
    tests::Random random(12);
    const Sample s = sample(offsets[1]);
    const Field f = tests::random_field(s.n_corners(), random),
                g = tests::random_field(s.n_corners(), random);
    Field all(s.map.n_dofs()), of_f(s.map.n_dofs()), of_g(s.map.n_dofs()),
        difference(s.map.n_dofs());
    s.map.apply_transposed(f, all);
    for (int b = 0; b < static_cast<int>(s.bodies.size()); ++b) {
        s.map.gather_at_nodes(b, f, of_f);
        s.map.gather_at_nodes(b, g, of_g);
        s.map.gather_at_nodes(b, f, g, difference);
    }
    REQUIRE(s.map.n_free() > 0);
    REQUIRE(s.map.n_free() < s.map.n_dofs());
    for (int i = 0; i < s.map.n_dofs(); ++i) {
        const Vec3 expected = sim::unpadded(all[i]);
        CHECK(sim::unpadded(of_f[i]) == (i < s.map.n_free() ? Vec3::Zero() : expected));
        CHECK((sim::unpadded(difference[i]) - sim::unpadded(of_f[i] - of_g[i])).norm()
              <= 1e-14);
    }
}

TEST_CASE("T of what is zero at most nodes is that of all") {
    tests::Random random(17);
    Sample s = sample(offsets[1]);
    s.bodies[0].kernel = GENERATE(sim::Kernel::Linear, sim::Kernel::Quadratic);
    s.bodies[1].kernel = sim::Kernel::Cubic;
    s.map.rebuild(s.corners, s.free, s.bodies);
    const Eigen::MatrixXd T = dense(s);
    const int n_dofs = s.map.n_dofs();
    const Field before = tests::random_field(s.n_corners(), random);
    Field q(n_dofs), u = before;
    Eigen::VectorXd few = Eigen::VectorXd::Zero(n_dofs);
    for (int i = 0; i < n_dofs; i += n_dofs / 5) {
        few[i] = tests::between(random, -1, 1);
        q[i] = Vec3p{0, few[i], 0, 0};
    }
    s.map.add_applied(q, u);
    const Eigen::VectorXd change = T * few;
    CHECK((change.array() == 0).count() > s.n_corners() / 4);
    CHECK((change.array() != 0).count() > 10);
    for (int c = 0; c < s.n_corners(); ++c)
        CHECK(u[c][1] == Approx(before[c][1] + change[c]).margin(1e-14));

    // Each degree of freedom by itself, whichever place of a stencil it has.
    for (int i = 0; i < n_dofs; ++i) {
        Field one(n_dofs), column(s.n_corners());
        one[i] = Vec3p{1, 1, 1, 0};
        s.map.add_applied(one, column);
        for (int c = 0; c < s.n_corners(); ++c)
            REQUIRE(column[c][1] == T(c, i));
    }
}

TEST_CASE("the degrees of freedom hold the whole mass for any free set") {
    for (const double share : {0.0, 0.1, 0.5, 1.0}) {
        const Sample s = sample(offsets[1], share);
        tests::Random random(5);
        Field mass(s.n_corners()), on_dofs(s.map.n_dofs()), ones(s.n_corners());
        double total = 0, gathered = 0;
        for (Vec3p& m : mass) {
            m = sim::padded(Vec3::Constant(tests::between(random, 0.5, 2)));
            total += m[0];
        }
        s.map.apply_transposed(mass, on_dofs);
        for (const Vec3p& m : on_dofs) {
            CHECK(m[0] >= 0);
            gathered += m[0];
        }
        CHECK(std::abs(gathered - total) <= 1e-14 * total);
        s.map.apply(Field(s.map.n_dofs(), Vec3p{1, 1, 1, 0}), ones);
        for (const Vec3p& one : ones)
            CHECK(std::abs(one[0] - 1) <= 1e-15);
        if (share == 1)
            CHECK(s.map.n_dofs() == s.n_corners());
    }
}

TEST_CASE("a field without corners has no degrees of freedom") {
    CornerMap map;
    map.rebuild({}, {}, {});
    CHECK(map.n_dofs() == 0);
    map.rebuild({}, {}, {{0, 0, 1.0}});
    CHECK(map.n_dofs() == 0);
}

TEST_CASE("a body that spreads over too many cells or nowhere has diverged") {
    CornerMap map;
    for (const double far : {1e4, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
        const Field corners = {Vec3p{0, 0, 0, 0}, Vec3p{far, far, far, 0}};
        try {
            map.rebuild(corners, {0, 0}, {{0, 2, 1.0}});
            FAIL("accepted");
        } catch (const assets::Error& error) {
            CHECK(error.kind() == assets::ErrorKind::Diverged);
        }
    }
}

TEST_CASE("the map is the same to the last bit for any number of threads") {
    const int n = 24;  // more cells and nodes than a chunk holds
    Sample s;
    tests::Random random(13);
    for (int k = 0; k < n * n * n; ++k)
        s.corners.push_back(sim::padded(Vec3(k % n, k / n % n, k / (n * n))
                                        + Vec3::Constant(0.5)
                                        + tests::random_vector(random, 0.9)));
    s.free.assign(s.corners.size(), 0);
    s.bodies = {{0, s.n_corners(), 1.0}};
    s.map.rebuild(s.corners, s.free, s.bodies);
    const Field q = tests::random_field(s.map.n_dofs(), random),
                f = tests::random_field(s.n_corners(), random);
    const auto both = [&](int threads) {
        Field u(s.n_corners()), Tt_f(s.map.n_dofs());
        tests::on_threads(threads, [&] {
            s.map.apply(q, u);
            s.map.apply_transposed(f, Tt_f);
        });
        u.insert(u.end(), Tt_f.begin(), Tt_f.end());
        return u;
    };
    const Field one = both(1), two = both(2);
    CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Vec3p)) == 0);
}
