// T and G with every kernel against splines written down the slow way, and the identities that they must keep.
#include "sim/grid/corner_map.h"
#include "tests/support/random_fields.h"
#include "tests/support/threads.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>

using sim::CornerMap;
using sim::Field;
using sim::Gradient;
using sim::Kernel;
using sim::Vec3p;
using Factor = sim::CornerMap::Factor;

namespace {

const std::vector<Kernel> kernels = {Kernel::Linear, Kernel::Quadratic, Kernel::Cubic};

/// The centred B-spline of an order, by Cox and de Boor's recursion.
double spline(int order, double x) {
    if (order == 0)
        return x >= -0.5 && x < 0.5 ? 1 : 0;
    const double half = (order + 1) / 2.0;
    return ((half + x) * spline(order - 1, x + 0.5) + (half - x) * spline(order - 1, x - 0.5))
           / order;
}

double slope(int order, double x) {
    return spline(order - 1, x + 0.5) - spline(order - 1, x - 0.5);
}

struct Sample {
    Field x;
    std::vector<CornerMap::BodyRange> bodies;
    CornerMap map;

    explicit Sample(Kernel kernel) {
        tests::Random random(7);
        for (int k = 0; k < 80; ++k)
            x.push_back(sim::padded(Vec3(1, -2, 0.3) + tests::random_vector(random, 0.1)));
        const int half = static_cast<int>(x.size()) / 2;
        bodies = {{0, half, 0.04, kernel}, {half, 2 * half, 0.07, kernel}};
        std::vector<char> free(x.size(), 0);
        free[3] = free[50] = 1;
        map.rebuild(x, free, bodies);
    }

    int body_of(int c) const { return c >= bodies[1].begin; }

    /// Weight of a degree of freedom at a slave, or its slope along an axis.
    double weight(int c, int i, int axis = -1) const {
        const int b = body_of(c), order = static_cast<int>(bodies[b].kernel) + 1;
        if (i < map.n_free() || map.dof_body()[i] != b)
            return 0;
        const double cell_size = bodies[b].cell_size;
        const Vec3 d = sim::unpadded(x[c] - map.dof_position()[i]) / cell_size;
        double result = 1;
        for (int k = 0; k < 3; ++k)
            result *= k == axis ? slope(order, d[k]) / cell_size : spline(order, d[k]);
        return result;
    }

    std::vector<Gradient> gradients(Factor factor, const Field& q) const {
        std::vector<Gradient> result(x.size());
        for (int b = 0; b < 2; ++b)
            map.visit_gradients(
                b, factor, q, [&](const CornerMap::Slaves& at, Gradient* values) {
                    for (int s = at.begin; s < at.end; ++s)
                        result[map.slave_corner()[s]] = values[s - at.begin];
                });
        return result;
    }

    Field transposed(Factor factor, const std::vector<Gradient>& A) const {
        Field result(map.n_dofs());
        for (int b = 0; b < 2; ++b)
            map.add_transposed(
                b,
                factor,
                [&](const CornerMap::Slaves& at, Gradient* values) {
                    for (int s = at.begin; s < at.end; ++s)
                        values[s - at.begin] = A[map.slave_corner()[s]];
                },
                result);
        return result;
    }

    bool is_slave(int c) const { return map.dof_of_corner()[c] < 0; }
};

std::vector<Gradient> random_gradients(std::size_t n, tests::Random& random) {
    std::vector<Gradient> result(n);
    for (Gradient& A : result)
        for (Vec3p& column : A.column)
            column = sim::padded(tests::random_vector(random));
    return result;
}

}  // namespace

TEST_CASE("T and G are made of B-splines and their slopes") {
    const Sample s(GENERATE(from_range(kernels)));
    tests::Random random(1);
    const Field q = tests::random_field(s.map.n_dofs(), random);
    Field u(s.x.size());
    s.map.apply(q, u);
    const auto D = s.gradients(Factor::Slope, q), B = s.gradients(Factor::Moment, q);
    for (int c = 0; c < static_cast<int>(s.x.size()); ++c) {
        if (!s.is_slave(c))
            continue;
        Vec3 expected = Vec3::Zero();
        Mat3 gradient = Mat3::Zero(), moment = Mat3::Zero();
        for (int i = 0; i < s.map.n_dofs(); ++i) {
            const Vec3 v = sim::unpadded(q[i]);
            const Vec3 arm = sim::unpadded(s.map.dof_position()[i] - s.x[c]);
            expected += s.weight(c, i) * v;
            moment += s.weight(c, i) * v * arm.transpose();
            for (int axis = 0; axis < 3; ++axis)
                gradient.col(axis) += s.weight(c, i, axis) * v;
        }
        CHECK((sim::unpadded(u[c]) - expected).norm() <= 1e-13);
        for (int axis = 0; axis < 3; ++axis) {
            // Slopes are of size 1/h, and positions are rounded to 2e-16 of 2 m, 1e-14 cells.
            CHECK((sim::unpadded(D[c].column[axis]) - gradient.col(axis)).norm() <= 1e-11);
            CHECK((sim::unpadded(B[c].column[axis]) - moment.col(axis)).norm() <= 1e-14);
        }
    }
}

TEST_CASE("affine fields have their own gradient, and constant ones none") {
    const Kernel kernel = GENERATE(from_range(kernels));
    const Sample s(kernel);
    tests::Random random(2);
    const Mat3 A = Mat3::NullaryExpr([&] { return tests::between(random, -1, 1); });
    Field q(s.map.n_dofs()), one(s.map.n_dofs(), Vec3p{1, 1, 1, 0}), u(s.x.size());
    for (int i = 0; i < s.map.n_dofs(); ++i)
        q[i] = sim::padded(A * sim::unpadded(s.map.dof_position()[i]));
    const auto D = s.gradients(Factor::Slope, q), zero = s.gradients(Factor::Slope, one),
               B = s.gradients(Factor::Moment, q);
    s.map.apply(one, u);
    for (int b = 0; b < 2; ++b) {
        const CornerMap::Slaves all = s.map.slaves_of(b);
        for (int slave = all.begin; slave < all.end; ++slave) {
            const int c = s.map.slave_corner()[slave];
            CHECK(std::abs(u[c][0] - 1) <= 1e-15);
            std::vector<CornerMap::Weight> row;
            s.map.find_row(c, row);
            Vec3p moment{};
            for (const auto& [i, w] : row) {
                const Vec3p arm = s.map.dof_position()[i] - s.x[c];
                moment += w * arm * arm;
            }
            for (int axis = 0; axis < 3; ++axis) {
                CHECK((sim::unpadded(D[c].column[axis]) - A.col(axis)).norm() <= 1e-12);
                CHECK(sim::unpadded(zero[c].column[axis]).norm() <= 1e-13 / 0.04);
                CHECK((sim::unpadded(B[c].column[axis]) - moment[axis] * A.col(axis)).norm()
                      <= 1e-14);
                if (kernel != Kernel::Linear)  // else it depends on the place
                    CHECK(std::abs(moment[axis] - s.map.second_moment(b)) <= 1e-14);
            }
        }
    }
}

TEST_CASE("the way back is the transpose, with every factor") {
    const Sample s(GENERATE(from_range(kernels)));
    const Factor factor = GENERATE(Factor::Slope, Factor::Moment);
    tests::Random random(3);
    const Field q = tests::random_field(s.map.n_dofs(), random),
                f = tests::random_field(s.x.size(), random);
    const auto A = random_gradients(s.x.size(), random);
    const auto D = s.gradients(factor, q);
    double sum = 0;
    for (std::size_t c = 0; c < s.x.size(); ++c)
        for (int j = 0; j < 3; ++j)
            sum += sim::dot(A[c].column[j], D[c].column[j]);
    REQUIRE(std::abs(sum) > 1e-3);
    CHECK(tests::dot(s.transposed(factor, A), q) == Approx(sum).epsilon(1e-12));

    Field u(s.x.size()), Tt_f(s.map.n_dofs());
    s.map.apply(q, u);
    s.map.apply_transposed(f, Tt_f);
    CHECK(tests::dot(u, f) == Approx(tests::dot(Tt_f, q)).epsilon(1e-12));
}

TEST_CASE("squared slopes and squared weights are those of the splines") {
    const Sample s(GENERATE(from_range(kernels)));
    tests::Random random(4);
    const auto A = random_gradients(s.x.size(), random);
    const Field k = tests::random_field(s.x.size(), random),
                sums = s.transposed(Factor::SlopeSquared, A);
    Field squares(s.map.n_dofs());
    s.map.apply_squared_transposed(k, squares);
    for (int i = s.map.n_free(); i < s.map.n_dofs(); ++i) {
        Vec3 expected = Vec3::Zero(), weights = Vec3::Zero();
        for (int c = 0; c < static_cast<int>(s.x.size()); ++c) {
            if (!s.is_slave(c))
                continue;
            weights += std::pow(s.weight(c, i), 2) * sim::unpadded(k[c]);
            for (int axis = 0; axis < 3; ++axis)
                expected +=
                    std::pow(s.weight(c, i, axis), 2) * sim::unpadded(A[c].column[axis]);
        }
        CHECK((sim::unpadded(sums[i]) - expected).norm() <= 1e-9);  // slopes² are up to 600
        CHECK((sim::unpadded(squares[i]) - weights).norm() <= 1e-13);
    }
}

TEST_CASE("there and back in one go is the same, to the last bit for any number of threads") {
    const Kernel kernel = GENERATE(from_range(kernels));
    const int n = 20;
    tests::Random random(13);
    Field x;
    for (int k = 0; k < n * n * n; ++k)
        x.push_back(sim::padded(Vec3(k % n, k / n % n, k / (n * n))
                                + tests::random_vector(random, 0.9)));
    CornerMap map;
    map.rebuild(x, std::vector<char>(x.size(), 0), {{0, n * n * n, 1.3, kernel}});
    const Field q = tests::random_field(map.n_dofs(), random);
    const auto twice = [&](const CornerMap::Slaves& at, Gradient* values) {
        for (int s = 0; s < at.end - at.begin; ++s)
            for (Vec3p& column : values[s].column)
                column *= 2;
    };
    const auto through = [&](int threads) {
        Field sums(map.n_dofs());
        tests::on_threads(threads, [&] { map.add_through(0, q, twice, sums); });
        return sums;
    };
    const Field one = through(1), two = through(2);
    CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Vec3p)) == 0);

    std::vector<Gradient> kept(x.size());
    map.visit_gradients(
        0, Factor::Slope, q, [&](const CornerMap::Slaves& at, Gradient* values) {
            twice(at, values);
            std::copy(values, values + (at.end - at.begin), &kept[at.begin]);
        });
    Field apart(map.n_dofs());
    map.add_transposed(
        0,
        Factor::Slope,
        [&](const CornerMap::Slaves& at, Gradient* values) {
            std::copy(&kept[at.begin], &kept[at.begin] + (at.end - at.begin), values);
        },
        apart);
    CHECK(std::memcmp(one.data(), apart.data(), one.size() * sizeof(Vec3p)) == 0);
}
