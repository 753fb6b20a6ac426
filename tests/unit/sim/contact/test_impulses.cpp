#include "sim/contact/impulses.h"
#include "tests/support/random_fields.h"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>

using sim::CornerMap;
using sim::Field;
using sim::Impulses;

namespace {

constexpr double dt = 0.01, edge = 0.1;
const Vec3 slope = Vec3(1, -2, 2) / 3;

/// Corners in a box, free or moved by a grid, and their degrees of freedom with random velocities and masses.
struct Corners {
    CornerMap map;
    std::vector<double> mass, inverse_mass;
    Field is_free, q;

    Corners(int n, bool are_free, tests::Random& random) {
        const Field x = tests::random_field(n, random, 1.5 * edge);
        map.rebuild(x, std::vector<char>(n, are_free), {{0, n, 2 * edge}});
        q = tests::random_field(map.n_dofs(), random);
        for (int i = 0; i < map.n_dofs(); ++i) {
            mass.push_back(tests::between(random, 0.1, 1));
            inverse_mass.push_back(1 / mass[i]);
            is_free.push_back(sim::padded(Vec3::Ones()));
        }
    }

    Impulses impulses() const {
        Impulses result(map, inverse_mass, is_free);
        result.begin_drift(dt);
        return result;
    }

    void settle(Impulses& impulses) {
        Field v = velocities();
        impulses.settle(q, v);
        const Field apart = tests::sum(v, -1, velocities());
        CHECK(tests::dot(apart, apart) < 1e-24);
    }

    Field velocities() const {
        Field v(map.dof_of_corner().size());
        map.apply(q, v);
        return v;
    }
};

/// The velocities next to q in kinetic energy whose contacts all end open or touching, by trying which of them touch.
/// Rows of `A`: how fast each gap grows by q.
Eigen::VectorXd nearest_allowed(const Eigen::MatrixXd& A,
                                const Eigen::VectorXd& gaps,
                                const Eigen::VectorXd& mass,
                                const Eigen::VectorXd& q) {
    const int n = static_cast<int>(gaps.size());
    for (int touching = 0; touching < (1 << n); ++touching) {
        std::vector<int> rows;
        for (int k = 0; k < n; ++k)
            if (touching >> k & 1)
                rows.push_back(k);
        const Eigen::MatrixXd B = A(rows, Eigen::all);
        const Eigen::MatrixXd through = mass.cwiseInverse().asDiagonal() * B.transpose();
        const Eigen::VectorXd push = (B * through).ldlt().solve(-gaps(rows) / dt - B * q);
        const Eigen::VectorXd end = q + through * push;
        if ((push.array() >= 0).all() && ((gaps + dt * A * end).array() >= -1e-9).all())
            return end;
    }
    FAIL("no set of contacts fits");
    return q;
}

}  // namespace

TEST_CASE("frictionless impulses change velocities by the least kinetic energy") {
    tests::Random random(1);
    const bool is_free = GENERATE(true, false);
    const int n = 7;
    double most_change = 0;
    for (int trial = 0; trial < 20; ++trial) {
        Corners corners(3 * n, is_free, random);
        const int n_dofs = corners.map.n_dofs();
        Impulses impulses = corners.impulses();
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, 3 * n_dofs);
        Eigen::VectorXd gaps(n), mass(3 * n_dofs);
        for (int i = 0; i < n_dofs; ++i)
            mass.segment<3>(3 * i).setConstant(corners.mass[i]);
        for (int k = 0; k < n; ++k) {
            const Vec3 normal = (slope + tests::random_vector(random, 0.3)).normalized();
            gaps[k] = tests::between(random, -0.05, 0.05) * edge;
            // Of one corner against another: both move.
            const Impulses::Share shares[] = {{k, 1}, {k + n, -0.3}, {k + 2 * n, -0.7}};
            const Impulses::Touch touch{normal, gaps[k], edge, {}, Vec3::Zero()};
            impulses.add(touch, impulses.row_of(shares));
            std::vector<CornerMap::Weight> row;
            for (const auto& [corner, weight] : shares) {
                corners.map.find_row(corner, row);
                for (const auto& [i, w] : row)
                    A.row(k).segment<3>(3 * i) += weight * w * normal.transpose();
            }
        }
        const auto flat_q = [&] {
            Eigen::VectorXd result(3 * n_dofs);
            for (int i = 0; i < n_dofs; ++i)
                result.segment<3>(3 * i) = sim::unpadded(corners.q[i]);
            return result;
        };
        const Eigen::VectorXd before = flat_q();
        corners.settle(impulses);
        const Eigen::VectorXd after = flat_q(),
                              expected = nearest_allowed(A, gaps, mass, before);
        most_change = std::max(most_change, (expected - before).lpNorm<Eigen::Infinity>());
        CHECK((after - expected).lpNorm<Eigen::Infinity>() < 1e-3 * edge / dt);
    }
    CHECK(most_change > 0.3);
}

TEST_CASE("a corner that slides on what moves is slowed by mu of what stops it, or held") {
    tests::Random random(2);
    const bool is_free = GENERATE(true, false);
    const double mu = GENERATE(0.0, 0.2, 50.0);
    const bool sticks = GENERATE(false, true);
    CAPTURE(is_free, mu, sticks);
    for (int trial = 0; trial < 20; ++trial) {
        Corners corners(30, is_free, random);
        const Vec3 carried = tests::random_vector(random, 0.1);
        const Vec3 before = sim::unpadded(corners.velocities()[3]) - carried;
        const double gap = tests::between(random, -0.1, 0.1) * edge;
        Impulses impulses = corners.impulses();
        impulses.add({slope, gap, edge, {sticks, mu}, carried}, impulses.row_of(3));
        corners.settle(impulses);
        const Vec3 after = sim::unpadded(corners.velocities()[3]) - carried;
        const double push = std::max(0.0, -gap / dt - slope.dot(before));  // per mass
        const Vec3 slip = before - slope.dot(before) * slope;
        const double kept = sticks && push > 0 ? 0 : std::max(0.0, 1 - mu * push / slip.norm());
        const Vec3 expected = (slope.dot(before) + push) * slope + kept * slip;
        CHECK((after - expected).norm() < 1e-10);
    }
}

TEST_CASE("what is held on all sides is left alone, by others too") {
    tests::Random random(3);
    Corners corners(2, true, random);
    corners.is_free[0] = sim::Vec3p{};
    const Field before = corners.q;
    Impulses impulses = corners.impulses();
    impulses.add({slope, -edge, edge, {true, 0}, Vec3::Zero()}, impulses.row_of(0));
    CHECK(impulses.size() == 0);
    impulses.add({slope, -edge, edge, {true, 0}, Vec3::Zero()},
                 impulses.row_of({{Impulses::Share{0, -1}, Impulses::Share{1, 1}}}));
    corners.settle(impulses);
    CHECK(sim::unpadded(corners.q[0] - before[0]).norm() == 0);
    const Vec3 apart = sim::unpadded(corners.q[1] - corners.q[0]);
    CHECK((apart - edge / dt * slope).norm() < 1e-10);
}
