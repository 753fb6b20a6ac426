// The energy of points against its own differences, against an obvious sum, and what it does not see.
#include "sim/materials/law.h"
#include "sim/points/plasticity.h"
#include "sim/points/point_energy.h"
#include "tests/support/box_body.h"
#include "tests/support/derivative_order.h"
#include "tests/support/random_fields.h"
#include "tests/support/threads.h"

#include <catch2/catch.hpp>

#include <cstring>

using sim::CornerMap;
using sim::Field;
using sim::Kernel;
using sim::Vec3p;

namespace {

constexpr double s = 0.05, h = 0.09, dt = 1e-2;

/// Two regions of different laws, points jittered and deformed.
struct Sample {
    sim::Body body;
    sim::MaterialPoints points;
    Field x;
    CornerMap map;
    sim::PointState state;
    std::unique_ptr<sim::PointEnergy> energy;

    Sample(Kernel kernel, sim::Model one, sim::Model other, std::array<int, 3> n = {4, 3, 3}) {
        tests::Random random(5);
        body = tests::box_body(n, s, {0.01, -0.33, 0.02});
        body.regions.push_back(
            tests::region("half", tests::behind({0.1, 0, 0}, {1, 0, 0}), 3e5));
        body.regions[0].model = one;
        body.regions[1].model = other;
        points = sim::seed_points(sim::make_lattice(body), body);
        state = sim::PointState(points.size());
        for (int p = 0; p < points.size(); ++p) {
            x.push_back(sim::padded(points.rest[p] + tests::random_vector(random, s / 3)));
            for (double& entry : state.F[p].m)
                entry += tests::between(random, -0.1, 0.1);
            state.J_plastic[p] = tests::between(random, 0.9, 1.1);
        }
        map.rebuild(x, std::vector<char>(x.size(), 0), {{0, points.size(), h, kernel}});
        energy = std::make_unique<sim::PointEnergy>(map, 0, 0, h, points);
        energy->begin_step(state);
    }

    Field motion(double size, unsigned seed) const {
        tests::Random random(seed);
        return tests::random_field(map.n_dofs(), random, size);
    }
};

const std::vector<std::pair<sim::Model, sim::Model>> laws = {
    {sim::Model::NeoHookean, sim::Model::FixedCorotated},
    {sim::Model::StableNeoHookean, sim::Model::Snow}};
const std::vector<Kernel> kernels = {Kernel::Linear, Kernel::Quadratic, Kernel::Cubic};

}  // namespace

namespace {

/// ∇v at the points.
std::vector<Mat3> gradients(const Sample& sample, const Field& v) {
    std::vector<Mat3> D(sample.points.size());
    sample.map.visit_gradients(
        0,
        CornerMap::Factor::Slope,
        v,
        [&](const CornerMap::Slaves& at, sim::Gradient* values) {
            for (int slave = at.begin; slave < at.end; ++slave)
                for (int j = 0; j < 3; ++j)
                    D[sample.map.slave_corner()[slave]].col(j) =
                        sim::unpadded(values[slave - at.begin].column[j]);
        });
    return D;
}

/// Of point p with F, and as hard as J_plastic makes it.   [J]
double energy_of(const Sample& sample, int p, const Mat3& F, double J_plastic) {
    sim::Matrix3<double> matrix;
    Eigen::Map<Mat3>(matrix.m) = F;
    const double harder = sample.points.is_snow(p) ? std::exp(10 * (1 - J_plastic)) : 1;
    return sample.points.volume[p]
           * sim::visit(sample.points.model[sample.points.region[p]], [&](auto law) {
                 return law.energy_density(
                     matrix, harder * sample.points.mu[p], harder * sample.points.lambda[p]);
             });
}

}  // namespace

TEST_CASE("the energy of points is that of their deformation gradients") {
    const Kernel kernel = GENERATE(from_range(kernels));
    const auto [one, other] = GENERATE(from_range(laws));
    const Sample sample(kernel, one, other);
    const Field q = sample.motion(0.3, 2);
    Field gradient(q.size());
    const double value = sample.energy->add_gradient(q, dt, gradient);

    double expected = 0;
    const std::vector<Mat3> D = gradients(sample, q);
    for (int p = 0; p < sample.points.size(); ++p)
        expected += energy_of(
            sample,
            p,
            (Mat3::Identity() + dt * D[p]) * Eigen::Map<const Mat3>(sample.state.F[p].m),
            sample.state.J_plastic[p]);
    REQUIRE(expected > 0);
    CHECK(value == Approx(expected).epsilon(1e-12));
}

TEST_CASE("snow yields at the end of each drift, and what has yielded moves on from there") {
    // The way is that since the start of the step, so a drift leads on from the one before.
    Sample sample(Kernel::Quadratic, sim::Model::StableNeoHookean, sim::Model::Snow);
    // F where the step would have begun for what is left.
    sim::PointState expected = sample.state;
    const Field first = sample.motion(3e-3, 2),
                both = tests::sum(first, 1, sample.motion(3e-3, 3));
    std::vector<sim::Matrix3<double>> F(sample.points.size());
    int n_yielded = 0;
    for (const Field& way : {first, both}) {
        Field gradient(way.size());
        Field x(sample.x.size()), moved;
        const double value = sample.energy->end_drift(way, sample.x, x, gradient);
        sample.map.move(sample.x, 1, way, moved);
        CHECK(tests::largest_difference(x, moved) < 1e-15);
        const std::vector<Mat3> D = gradients(sample, way);
        double energy = 0;
        for (int p = 0; p < sample.points.size(); ++p) {
            Eigen::Map<Mat3>(F[p].m) =
                (Mat3::Identity() + D[p]) * Eigen::Map<const Mat3>(expected.F[p].m);
            const double before = expected.J_plastic[p];
            if (sample.points.is_snow(p))
                sim::yield(sample.points.snow[sample.points.region[p]],
                           F[p],
                           expected.F[p],
                           expected.J_plastic[p]);
            n_yielded += expected.J_plastic[p] != before;
            energy +=
                energy_of(sample, p, Eigen::Map<const Mat3>(F[p].m), expected.J_plastic[p]);
        }
        CHECK(value == Approx(energy).epsilon(1e-11));
    }
    CHECK(n_yielded > 20);
    sample.energy->accept(sample.state);
    for (int p = 0; p < sample.points.size(); ++p) {
        const Eigen::Map<const Mat3> is(sample.state.F[p].m), wanted(F[p].m);
        CHECK((is - wanted).norm() < 1e-12);
        CHECK(sample.state.J_plastic[p] == Approx(expected.J_plastic[p]).epsilon(1e-12));
    }
}

TEST_CASE("snow that has yielded again is as hard as snow that comes so") {
    Sample sample(Kernel::Quadratic, sim::Model::StableNeoHookean, sim::Model::Snow);
    const double before = sample.energy->energy(sample.state);
    for (int p = 0; p < sample.points.size(); p += 2)
        sample.state.J_plastic[p] *= 0.97;
    sample.energy->begin_step(sample.state);
    sim::PointEnergy other(sample.map, 0, 0, h, sample.points);
    other.begin_step(sample.state);
    CHECK(sample.energy->energy(sample.state) > before);
    CHECK(sample.energy->energy(sample.state) == other.energy(sample.state));
}

TEST_CASE("gradient and Hessian of points are derivatives") {
    const Kernel kernel = GENERATE(from_range(kernels));
    const auto [one, other] = GENERATE(from_range(laws));
    const Sample sample(kernel, one, other);
    sim::PointEnergy& energy = *sample.energy;
    const Field q = sample.motion(0.3, 2), direction = sample.motion(1, 3);
    const auto value_at = [&](double t, Field& gradient) {
        gradient.assign(q.size(), Vec3p{});
        return energy.add_gradient(tests::sum(q, t, direction), dt, gradient);
    };
    Field gradient, up, down;
    value_at(0, gradient);
    const double slope = dt * tests::dot(gradient, direction);  // u = dt q
    REQUIRE(slope != 0);
    const auto error = [&](double t) {
        return (value_at(t, up) - value_at(-t, down)) / (2 * t) - slope;
    };
    CHECK(tests::observed_order(error, 0.3) == Approx(2).margin(0.1));

    // The stiffness is kept in single precision, so its error ends there: 1e-6 of the product.
    energy.linearize(q, dt, false);
    Field product(q.size());
    energy.add_product(direction, product);
    const double t = 1e-3;
    value_at(t, up);
    value_at(-t, down);
    const Field difference = tests::sum(up, -1, down);
    double off = 0, size = 0;
    for (std::size_t i = 0; i < q.size(); ++i) {
        const Vec3p d = difference[i] / (2 * t * dt) - product[i];
        off += sim::dot(d, d);
        size += sim::dot(product[i], product[i]);
    }
    REQUIRE(size > 0);
    CHECK(std::sqrt(off / size) <= 2e-6);

    // Symmetric, and positive once projected.
    Field other_product(q.size());
    energy.add_product(q, other_product);
    CHECK(tests::dot(other_product, direction) == Approx(tests::dot(product, q)).epsilon(1e-6));
    energy.linearize(q, dt, true);
    for (unsigned seed = 0; seed < 10; ++seed) {
        const Field p = sample.motion(1, seed);
        Field Ap(q.size());
        energy.add_product(p, Ap);
        CHECK(tests::dot(p, Ap) >= 0);
    }
}

TEST_CASE("forces of points sum to zero and turn nothing") {
    const Kernel kernel = GENERATE(from_range(kernels));
    const Sample sample(kernel, laws[0].first, laws[0].second);
    Field gradient(sample.map.n_dofs());
    sample.energy->add_start_gradient(gradient);
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    double size = 0;
    for (int i = 0; i < sample.map.n_dofs(); ++i) {
        const Vec3 f = sim::unpadded(gradient[i]);
        force += f;
        moment += sim::unpadded(sample.map.dof_position()[i]).cross(f);
        size += f.norm();
    }
    REQUIRE(size > 0);
    CHECK(force.norm() <= 1e-13 * size);
    CHECK(moment.norm() <= 1e-13 * size);
}

TEST_CASE(
    "energy and forces of points are the same to the last bit for any number of threads") {
    Sample sample(Kernel::Quadratic, laws[0].first, laws[0].second, {30, 20, 20});
    const Field q = sample.motion(0.3, 2);
    const auto work = [&](int threads) {
        Field result(q.size());
        tests::on_threads(threads, [&] {
            const double value = sample.energy->add_gradient(q, dt, result);
            sample.energy->linearize(q, dt, false);
            sample.energy->add_product(q, result);
            result.push_back(Vec3p{value, 0, 0, 0});
        });
        return result;
    };
    const Field one = work(1), two = work(2);
    CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Vec3p)) == 0);
}
