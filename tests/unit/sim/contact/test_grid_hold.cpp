#include "sim/contact/grid_hold.h"
#include "tests/support/derivative_order.h"
#include "tests/support/random_fields.h"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>

#include <cmath>

using sim::Field;
using sim::GridHold;
using sim::Impulses;
using sim::Vec3p;

namespace {

constexpr int n = 12;  // corners
constexpr double dt = 0.01, edge = 0.1;

/// Masses of corners that fly towards each other, some by some, from where the step starts.
struct Flight {
    Field x_n, v, is_free;
    std::vector<double> mass, inverse_mass;
    sim::CornerMap map;

    explicit Flight(tests::Random& random)
        : x_n(tests::random_field(n, random, edge)), v(tests::random_field(n, random)) {
        for (int c = 0; c < n; ++c) {
            mass.push_back(tests::between(random, 0.5, 2));
            inverse_mass.push_back(1 / mass[c]);
            is_free.push_back(sim::padded(Vec3::Ones()));
        }
        map.rebuild(x_n, std::vector<char>(n, 1), {{0, n, edge}});
    }

    GridHold::Contact contact(int number,
                              const sim::Friction& friction,
                              tests::Random& random) const {
        GridHold::Contact contact;
        contact.place = {0, number};
        contact.normal = tests::random_vector(random).normalized();
        contact.edge = edge;
        contact.friction = friction;
        for (int c = number; c < n; c += 2)  // two corners apart: neighbours share some
            contact.shares.push_back(
                {c, (c % 4 < 2 ? -1 : 1) * tests::between(random, 0.1, 1)});
        double inverse = 0;
        Vec3 rate = Vec3::Zero();
        for (const auto& [c, weight] : contact.shares) {
            inverse += weight * weight * inverse_mass[c];
            rate += weight * sim::unpadded(v[c]);
        }
        contact.mass = 1 / inverse;
        if (rate.dot(contact.normal) > 0)
            contact.normal *= -1;  // as they approach
        return contact;
    }

    Field end(const Field& q) const { return tests::sum(x_n, dt, q); }

    /// The least of 1/2 |q - v|²_M + hold, from q = v.
    Field solve(GridHold& hold) const {
        Field q = v;
        for (int k = 0; k < 50; ++k) {
            Field gradient(n, Vec3p{});
            hold.add_gradient(end(q), gradient);
            hold.linearize(end(q));
            Eigen::VectorXd g(3 * n);
            Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3 * n, 3 * n);
            for (int i = 0; i < 3 * n; ++i) {
                g[i] = mass[i / 3] * (q[i / 3][i % 3] - v[i / 3][i % 3])
                       + dt * gradient[i / 3][i % 3];
                Field unit(n, Vec3p{}), product(n, Vec3p{});
                unit[i / 3][i % 3] = 1;
                hold.add_product(unit, product);
                for (int j = 0; j < 3 * n; ++j)
                    H(j, i) = dt * dt * product[j / 3][j % 3];
                H(i, i) += mass[i / 3];
            }
            const Eigen::VectorXd step = H.ldlt().solve(g);
            for (int i = 0; i < 3 * n; ++i)
                q[i / 3][i % 3] -= step[i];
        }
        return q;
    }
};

double energy(const GridHold& hold, const Field& x) {
    Field unused(x.size(), Vec3p{});
    return hold.add_gradient(x, unused);
}

Field gradient(const GridHold& hold, const Field& x) {
    Field g(x.size(), Vec3p{});
    hold.add_gradient(x, g);
    return g;
}

}  // namespace

TEST_CASE("gradient and Hessian of contact held on the grid are those of its energy") {
    tests::Random random(1);
    const Flight flight(random);
    const sim::Friction friction =
        GENERATE(sim::Friction{false, 0}, sim::Friction{false, 0.3}, sim::Friction{true, 0});
    CAPTURE(friction.stick, friction.coefficient);
    GridHold hold;
    hold.begin_step(flight.x_n, dt);
    std::vector<GridHold::Contact> met;
    for (int k = 0; k < 4; ++k) {
        met.push_back(flight.contact(k, friction, random));
        met[k].push = 50.0 * (k + 1);
        met[k].hold = tests::random_vector(random, 10);
        met[k].hold -= met[k].normal * met[k].normal.dot(met[k].hold);
    }
    hold.update(flight.x_n, met);
    const Field x = flight.end(flight.v), way = tests::random_field(n, random);
    hold.linearize(x);
    Field product(n, Vec3p{}), diagonal(n, Vec3p{});
    hold.add_product(way, product);
    CHECK(tests::dot(way, product) >= 0);
    const auto slope_error = [&](double h) {
        return (energy(hold, tests::sum(x, h, way)) - energy(hold, tests::sum(x, -h, way)))
                   / (2 * h)
               - tests::dot(gradient(hold, x), way);
    };
    const auto curvature_error = [&](double h) {
        const Field change = tests::sum(gradient(hold, tests::sum(x, h, way)),
                                        -1,
                                        gradient(hold, tests::sum(x, -h, way))),
                    error = tests::sum(change, -2 * h, product);
        return std::sqrt(tests::dot(error, error)) / (2 * h);
    };
    // Where it is quadratic, central differences of it are exact.
    const double size = std::sqrt(tests::dot(product, product));
    if (friction.coefficient > 0) {
        CHECK(tests::observed_order(slope_error, 1e-4) > 1.9);
        CHECK(tests::observed_order(curvature_error, 1e-4) > 1.9);
    } else {
        CHECK(std::abs(slope_error(1e-6)) < 1e-6 * size);
        CHECK(curvature_error(1e-6) < 1e-6 * size);
    }
    hold.add_diagonal(diagonal);
    for (int i = 0; i < 3 * n; ++i) {
        Field unit(n, Vec3p{}), column(n, Vec3p{});
        unit[i / 3][i % 3] = 1;
        hold.add_product(unit, column);
        CHECK(diagonal[i / 3][i % 3] == Approx(column[i / 3][i % 3]).margin(1e-12 * size));
    }
}

TEST_CASE("masses alone end the step as impulses after the solve would have them") {
    // Of several contacts the end is unique where nothing rubs, of one in any case.
    const auto [n_contacts, friction] = GENERATE(std::pair{4, sim::Friction{false, 0}},
                                                 std::pair{1, sim::Friction{false, 0.3}},
                                                 std::pair{1, sim::Friction{true, 0}});
    const int seed = GENERATE(range(1, 6));
    CAPTURE(n_contacts, friction.stick, friction.coefficient, seed);
    tests::Random random(seed);
    const Flight flight(random);
    std::vector<GridHold::Contact> met;
    Impulses impulses(flight.map, flight.inverse_mass, flight.is_free);
    impulses.begin_drift(dt);
    for (int k = 0; k < n_contacts; ++k) {
        met.push_back(flight.contact(k, friction, random));
        impulses.add({met[k].normal, 0, edge, friction}, impulses.row_of(met[k].shares));
    }
    Field expected = flight.v, moved = flight.v;
    for (int k = 0; k < 20; ++k)  // it is content with 1e-4 of an edge
        impulses.settle(expected, moved);

    GridHold hold;
    hold.begin_step(flight.x_n, dt);
    bool is_settled = hold.update(flight.end(flight.v), met);
    Field q;
    for (int pass = 0; pass < 30; ++pass) {
        q = flight.solve(hold);
        is_settled = hold.update(flight.end(q), {});
    }
    CHECK(is_settled);
    const Field error = tests::sum(q, -1, expected),
                change = tests::sum(expected, -1, flight.v);
    CHECK(std::sqrt(tests::dot(error, error)) < 1e-6 * std::sqrt(tests::dot(change, change)));
    for (int k = 0; k < n_contacts; ++k)
        CHECK(hold.has({0, k}));
    CHECK(!hold.has({0, n_contacts}));
}
