#include <catch2/catch.hpp>

#include "assets/base/error.h"
#include "sim/grid/corner_map.h"
#include "tests/support/random_fields.h"
#include "tests/support/threads.h"

#include <Eigen/Dense>

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
            s.corners.push_back(sim::padded(h[b] * offset + tests::random_vector(random, 2 * h[0])));
        for (int k = 0; k < 27; ++k)  // halves of the cell: nodes, edge middles, face and cell centres
            s.corners.push_back(sim::padded(h[b] * (offset + Vec3(k % 3, k / 3 % 3, k / 9) / 2)));
        s.bodies.push_back({begin, s.n_corners(), h[b]});
    }
    for (int c = 0; c < s.n_corners(); ++c)
        s.free.push_back(tests::between(random, 0, 1) < share_free);
    s.map.rebuild(s.corners, s.free, s.bodies);
    return s;
}

const std::vector<Vec3> offsets = {{0, 0, 0}, {-3.25, 0.5, -1}, {1e4, -2e4, 1e3 + 0.3}};

Field uniform(int n, const Vec3p& value) {
    return Field(n, value);
}

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

/// Π (1 - |x/h - k|): the hat function of grid node k.
double hat(const Vec3& x, const Vec3& k, double h) {
    return (Vec3::Ones() - (x / h - k).cwiseAbs()).cwiseMax(0).prod();
}

}  // namespace

TEST_CASE("the columns of T are unit vectors of free corners and hat functions of grid nodes") {
    for (const Vec3& offset : offsets) {
        CAPTURE(offset.transpose());
        const Sample s = sample(offset);
        const Eigen::MatrixXd T = dense(s);
        const double rounding = 1e-15 * (1 + offset.norm());
        std::set<std::array<double, 4>> nodes;
        for (int i = s.map.n_free(); i < s.map.n_dofs(); ++i) {
            // The node is one of the eight around the corner it acts on most.
            int c = 0;
            T.col(i).maxCoeff(&c);
            const int b = c >= s.bodies[1].begin;
            const double h = s.bodies[b].cell_size;
            const Vec3 x = sim::unpadded(s.corners[c]);
            double best = 1e300;
            Vec3 best_node = Vec3::Zero();
            for (int a = 0; a < 27; ++a) {
                const Vec3 k = (x / h).array().round() + Eigen::Array3d(a % 3 - 1, a / 3 % 3 - 1, a / 9 - 1);
                double error = 0;
                for (int d = 0; d < s.n_corners(); ++d) {
                    const bool slave_of_body =
                        !s.free[d] && d >= s.bodies[b].begin && d < s.bodies[b].end;
                    const double expected = slave_of_body ? hat(sim::unpadded(s.corners[d]), k, h) : 0;
                    error = std::max(error, std::abs(T(d, i) - expected));
                }
                if (error < best) {
                    best = error;
                    best_node = k;
                }
            }
            CHECK(best <= 10 * rounding);
            if (T.col(i).maxCoeff() > 10 * rounding)  // else no corner tells where the node is
                CHECK(nodes.insert({double(b), best_node.x(), best_node.y(), best_node.z()}).second);
        }
        for (int k = 0; k < s.map.n_free(); ++k) {
            const int c = s.map.free_corner()[k];
            CHECK(s.map.dof_of_corner()[c] == k);
            CHECK(T.col(k) == Eigen::VectorXd::Unit(s.n_corners(), c));
            CHECK(T.row(c).transpose() == Eigen::VectorXd::Unit(s.map.n_dofs(), k));
        }
        for (int c = 0; c < s.n_corners(); ++c)
            CHECK((s.map.dof_of_corner()[c] >= 0) == bool(s.free[c]));
    }
}

TEST_CASE("T reproduces affine fields at slaved corners") {
    tests::Random random(3);
    const Mat3 A = Mat3::NullaryExpr([&] { return tests::between(random, -1, 1); });
    const Vec3 b(0.3, -2, 1);
    for (const Vec3& offset : offsets) {
        // Nodes by weighted position: Tᵀ T is not diagonal, so find node positions X from T X = corners.
        const Sample s = sample(offset);
        const Eigen::MatrixXd T = dense(s);
        Eigen::MatrixXd x(s.n_corners(), 3);
        for (int c = 0; c < s.n_corners(); ++c)
            x.row(c) = sim::unpadded(s.corners[c]);
        const Eigen::MatrixXd X = T.completeOrthogonalDecomposition().solve(x);
        CHECK((T * X - x).norm() <= 1e-12 * x.norm());
        Field q(s.map.n_dofs()), u(s.n_corners());
        for (int i = 0; i < s.map.n_dofs(); ++i)
            q[i] = sim::padded(A * Vec3(X.row(i)) + b);
        s.map.apply(q, u);
        for (int c = 0; c < s.n_corners(); ++c) {
            const Vec3 expected = A * sim::unpadded(s.corners[c]) + b;
            CHECK((sim::unpadded(u[c]) - expected).norm() <= 1e-12 * (expected.norm() + x.norm()));
        }
    }
}

TEST_CASE("the gathers are the transposes of T and of its squares") {
    tests::Random random(11);
    const Sample s = sample(offsets[1]);
    const Eigen::MatrixXd T = dense(s);
    const Field q = tests::random_field(s.map.n_dofs(), random), f = tests::random_field(s.n_corners(), random);
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
        s.map.apply(uniform(s.map.n_dofs(), Vec3p{1, 1, 1, 0}), ones);
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
        s.corners.push_back(
            sim::padded(Vec3(k % n, k / n % n, k / (n * n)) + Vec3::Constant(0.5) + tests::random_vector(random, 0.9)));
    s.free.assign(s.corners.size(), 0);
    s.bodies = {{0, s.n_corners(), 1.0}};
    s.map.rebuild(s.corners, s.free, s.bodies);
    const Field q = tests::random_field(s.map.n_dofs(), random), f = tests::random_field(s.n_corners(), random);
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
