#include "sim/contact/collider_contact.h"
#include "tests/support/derivative_order.h"
#include "tests/support/random_fields.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

using sim::Collider;
using sim::ColliderContact;
using sim::Field;

namespace {

constexpr double stiffness = 3e4, mass = 0.01, edge = 0.1, dt = 0.01, slip_length = 1e-3 * dt;
constexpr double coarse = 0.25;               // edge of domains against shapes that are sampled
constexpr double half_a_domain = coarse / 2;  // from a material point to where it ends
const Vec3 slope_normal = Vec3(1, -2, 4).normalized();

const sim::PlaneShape plane{{0.1, 0.2, 0.3}, 7 * slope_normal};
const std::vector<double> at_rest{0};  // top speeds
const assets::Sphere sphere{{1, 2, 3}, 0.5};
const assets::Box box{{-1, -2, -3}, {1, 2, 3}};

// As a mesh would be.
const assets::Shape sampled_sphere =
    assets::Combination{assets::Combination::Kind::Union, {{sphere}}, 0};

ColliderContact contact_of(const Collider& collider, double outside = 0) {
    return {{collider}, {{0, 0, outside, stiffness, mass, edge}}};
}

struct Response {
    double energy = 0;
    Vec3 force{0, 0, 0};
};

Response response(const ColliderContact& contact, const Vec3& x) {
    Field gradient(1);
    const double energy = contact.add_gradient({sim::padded(x)}, gradient);
    return {energy, -sim::unpadded(gradient[0])};
}

void check_push(
    const Collider& collider, double outside, const Vec3& x, double depth, const Vec3& normal) {
    const Response r = response(contact_of(collider, outside), x);
    CHECK(r.energy == Approx(stiffness * depth * depth / 2));
    CHECK((r.force - stiffness * depth * normal).norm() <= 1e-9 * stiffness);
}

struct Start {
    Collider collider;
    Vec3 x_n;  // in the collider
};

/// A collider of every shape with friction, and a place inside.
std::vector<Start> starts(const sim::Friction& friction) {
    return {{{plane, friction}, plane.point - 0.01 * slope_normal},
            {{sphere, friction}, sphere.center + 0.48 * Vec3(1, 1, -1).normalized()},
            {{box, friction}, {0.2, 0.1, 2.99}}};
}

const sim::Friction rough{false, 0.7}, sticking{true, 0};

}  // namespace

TEST_CASE(
    "corners are pushed out along the outward normal, by the depth of the body's surface") {
    const Vec3 tangent = slope_normal.cross(Vec3::UnitX());
    check_push({plane, {}}, 0, plane.point + tangent - 0.02 * slope_normal, 0.02, slope_normal);
    check_push(
        {plane, {}}, 0.015, plane.point + tangent - 0.02 * slope_normal, 0.005, slope_normal);
    check_push({plane, {}}, 0.03, plane.point + tangent - 0.02 * slope_normal, 0, slope_normal);
    check_push({plane, {}}, 0, plane.point + 0.02 * slope_normal, 0, slope_normal);

    const Vec3 along = Vec3(2, -1, 2) / 3;
    check_push({sphere, {}}, 0, sphere.center + 0.4 * along, 0.1, along);
    check_push({sphere, {}}, 0.02, sphere.center + 0.4 * along, 0.08, along);
    check_push({sphere, {}}, 0, sphere.center + 0.51 * along, 0, along);
    check_push({sphere, {}}, 0, sphere.center, 0.5, Vec3::UnitZ());  // any way out is as good

    check_push({box, {}}, 0, {0.9, 1.5, 0}, 0.1, Vec3::UnitX());
    check_push({box, {}}, 0, {0.5, -1.75, 2}, 0.25, -Vec3::UnitY());
    check_push({box, {}}, 0.05, {0, 0, 2.9}, 0.05, Vec3::UnitZ());
    check_push({box, {}}, 0, {1.1, 2.1, 0}, 0, Vec3::UnitX());
}

TEST_CASE("nothing touches where there are no colliders or no corners") {
    const Field x = {sim::padded(plane.point - slope_normal)};
    for (ColliderContact contact : {ColliderContact({}, {{0, 0, 0, stiffness, mass, edge}}),
                                    ColliderContact({Collider{plane, {}, {}}}, {})}) {
        CHECK(contact.empty());
        Field field(1);
        contact.begin_step(x, at_rest, 0, dt);
        CHECK(contact.add_gradient(x, field) == 0);
        contact.linearize(x);
        contact.add_product(x, field);
        contact.add_diagonal(field);
        CHECK(sim::unpadded(field[0]).norm() == 0);
    }
}

TEST_CASE("friction is mu N against the slip, with the normal force of the step's start") {
    const double depth = 0.01, mu = 0.4, N = stiffness * depth;
    const Vec3 x_n = plane.point - depth * slope_normal,
               t = slope_normal.cross(Vec3::UnitY()).normalized();
    ColliderContact contact = contact_of({plane, {false, mu}});
    contact.begin_step({sim::padded(x_n)}, at_rest, 0, dt);
    const auto force_at = [&](double slip, double normal_motion) {
        const Response r = response(contact, x_n + slip * t + normal_motion * slope_normal);
        const double now = stiffness * std::max(0.0, depth - normal_motion);
        return Vec3(r.force - now * slope_normal);  // without what the penalty gives now
    };
    CHECK((force_at(5 * slip_length, 0) + mu * N * t).norm() <= 1e-9 * N);
    CHECK((force_at(-5 * slip_length, 0) - mu * N * t).norm() <= 1e-9 * N);
    CHECK((force_at(5 * slip_length, -0.5 * depth) + mu * N * t).norm() <= 1e-9 * N);
    CHECK((force_at(5 * slip_length, 2 * depth) + mu * N * t).norm() <= 1e-9 * N);
    CHECK((force_at(0.25 * slip_length, 0) + 0.25 * mu * N * t).norm() <= 1e-9 * N);

    contact.begin_step({sim::padded(x_n)}, at_rest, 0, 0);  // statics
    CHECK(force_at(5 * slip_length, 0).norm() <= 1e-9 * N);
    contact.begin_step({sim::padded(x_n + 2 * depth * slope_normal)},
                       at_rest,
                       0,
                       dt);  // no touch at the start
    CHECK(force_at(5 * slip_length, 0).norm() <= 1e-9 * N);
}

TEST_CASE("what sticks is held by a spring that nothing makes slide") {
    const double depth = 0.01;
    const Vec3 x_n = plane.point - depth * slope_normal,
               t = slope_normal.cross(Vec3::UnitY()).normalized();
    ColliderContact contact = contact_of({plane, {true, 0}});
    contact.begin_step({sim::padded(x_n)}, at_rest, 0, dt);
    for (const double slip : {0.25 * slip_length, 100 * slip_length, depth})
        CHECK((response(contact, x_n + slip * t).force
               - stiffness * (depth * slope_normal - slip * t))
                  .norm()
              <= 1e-9 * stiffness * depth);
    contact.begin_step({sim::padded(x_n + 2 * depth * slope_normal)},
                       at_rest,
                       0,
                       dt);  // no touch at the start
    CHECK((response(contact, x_n + depth * t).force - stiffness * depth * slope_normal).norm()
          <= 1e-9 * stiffness * depth);
}

TEST_CASE("the force is minus the energy's gradient, by observed order") {
    tests::Random random(1);
    const sim::Friction friction = GENERATE(rough, sticking);
    for (const Start& start : starts(friction))
        for (const double slip : {0.4 * slip_length, 40 * slip_length})
            for (int repeat = 0; repeat < 5; ++repeat) {
                ColliderContact contact = contact_of(start.collider);
                contact.begin_step({sim::padded(start.x_n)}, at_rest, 0, dt);
                const Vec3 x = start.x_n + slip * tests::random_vector(random).normalized();
                const Vec3 direction = tests::random_vector(random).normalized();
                const double exact = -response(contact, x).force.dot(direction);
                const double h = 0.2 * slip;
                const auto error = [&](double step) {
                    const double difference = response(contact, x + step * direction).energy
                                              - response(contact, x - step * direction).energy;
                    return difference / (2 * step) - exact;
                };
                CAPTURE(start.x_n.transpose(), slip, exact, error(h), error(h / 10));
                REQUIRE(std::abs(exact) > 1e-3);
                // Where the energy is quadratic differences are exact, up to its rounding.
                const double rounding = 1e-14 * response(contact, x).energy / (h / 10);
                if (std::abs(error(h / 10)) > 10 * rounding)
                    CHECK(tests::observed_order(error, h) == Approx(2).margin(0.15));
            }
}

TEST_CASE("the Hessian is the gradient's derivative on a plane, and positive everywhere") {
    tests::Random random(2);
    const sim::Friction friction = GENERATE(rough, sticking);
    const Start start = starts(friction)[0];
    for (const double slip : {0.4 * slip_length, 40 * slip_length})
        for (int repeat = 0; repeat < 5; ++repeat) {
            ColliderContact contact = contact_of(start.collider);
            contact.begin_step({sim::padded(start.x_n)}, at_rest, 0, dt);
            const Vec3 x = start.x_n + slip * tests::random_vector(random).normalized();
            const Vec3 direction = tests::random_vector(random).normalized();
            contact.linearize({sim::padded(x)});
            contact.linearize({sim::padded(x)});  // when friction knows its direction
            Field product(1);
            contact.add_product({sim::padded(direction)}, product);
            const Vec3 exact = sim::unpadded(product[0]);
            const double h = 0.1 * slip;
            const auto error = [&](double step) {
                return (-(response(contact, x + step * direction).force
                          - response(contact, x - step * direction).force)
                            / (2 * step)
                        - exact)
                    .norm();
            };
            CAPTURE(slip, exact.transpose(), error(h), error(h / 10));
            if (error(h / 10) > 1e-6 * exact.norm())
                CHECK(tests::observed_order(error, h) == Approx(2).margin(0.15));
        }
    for (const Start& any : starts(friction))
        for (int repeat = 0; repeat < 20; ++repeat) {
            ColliderContact contact = contact_of(any.collider);
            contact.begin_step({sim::padded(any.x_n)}, at_rest, 0, dt);
            contact.linearize(
                {sim::padded(any.x_n + tests::random_vector(random, 3 * slip_length))});
            Field diagonal(1);
            contact.add_diagonal(diagonal);
            Mat3 H;
            for (int axis = 0; axis < 3; ++axis) {
                Field column(1);
                contact.add_product({sim::padded(Vec3::Unit(axis))}, column);
                H.col(axis) = sim::unpadded(column[0]);
                CHECK(H(axis, axis) == diagonal[0][axis]);
            }
            CHECK((H - H.transpose()).norm() <= 1e-12 * H.norm());
            const Vec3 u = tests::random_vector(random);
            CHECK(u.dot(H * u) >= -1e-12 * H.norm());
        }
}

TEST_CASE("whatever is tried within a step, a thin wall pushes back to the side of the start") {
    const double thickness = 0.02;
    const Collider wall{assets::Box{{-1, -1, -thickness}, {1, 1, 0}}, sim::Friction{false, 0}};
    ColliderContact contact = contact_of(wall);
    for (const double side : {1.0, -1.0}) {
        const double face = side > 0 ? 0 : -thickness;
        contact.begin_step({sim::padded(Vec3(0.1, 0.2, face + side * 0.001))}, at_rest, 0, dt);
        for (const double depth : {0.002, 0.9 * thickness, 3 * thickness}) {
            const Response r = response(contact, {0.1, 0.2, face - side * depth});
            CHECK(r.energy == Approx(stiffness * depth * depth / 2));
            CHECK(r.force.z() == Approx(side * stiffness * depth));
        }
    }
}

TEST_CASE(
    "a material point touches what is sampled where its little cube does, nowhere else "
    "around") {
    tests::Random random(5);
    std::size_t n_touched = 0;
    const ColliderContact contact({Collider{sampled_sphere, {}}},
                                  {{0, 0, -half_a_domain, stiffness, mass, coarse}});
    for (int repeat = 0; repeat < 4000; ++repeat) {
        const Vec3 x =
            sphere.center
            + tests::between(random, 0.3, 1.4) * tests::random_vector(random).normalized();
        const double gap = assets::signed_distance(sphere, x) - half_a_domain;
        const double depth = std::sqrt(2 * response(contact, x).energy / stiffness);
        CAPTURE(x.transpose(), gap);
        // Voxels of coarse/4: they err by 2/0.3 voxel²/8 at most.
        CHECK(std::abs(depth - std::max(0.0, -gap)) < 0.014 * coarse);
        n_touched += depth > 0;
    }
    CHECK(n_touched > 100);
}

namespace {

/// Corners that wander in and out of every shape: one contact that has followed them, one that starts here.
void check_followed(const Start& start, double outside, double domain_edge) {
    tests::Random random(4);
    std::size_t n_touched = 0, n_free = 0;
    std::vector<sim::ContactCorner> corners;
    Field x, v;
    for (int c = 0; c < 40; ++c) {
        corners.push_back({c, 0, outside, stiffness, mass, domain_edge});
        x.push_back(sim::padded(start.x_n + tests::random_vector(random, 0.4)));
        v.push_back(sim::padded(tests::random_vector(random, 2)));
    }
    ColliderContact followed({start.collider}, corners);
    const ColliderContact unused({start.collider}, corners);
    for (int step = 0; step < 200; ++step) {
        ColliderContact fresh = unused;
        Field x_end = x, gradient(x.size()), expected(x.size());
        for (std::size_t c = 0; c < x.size(); ++c) {
            // Now and then far within one step.
            const double length = step % 20 == 7 ? 10 * dt : dt;
            x_end[c] += length * v[c];
            if (step % 25 == 24)
                v[c] = -v[c];
        }
        const double time = step * dt;
        followed.begin_step(x, at_rest, time, dt);
        fresh.begin_step(x, at_rest, time, dt);
        CHECK(followed.add_gradient(x_end, gradient) == fresh.add_gradient(x_end, expected));
        CHECK(followed.has_changed_touch(x_end) == fresh.has_changed_touch(x_end));
        for (std::size_t c = 0; c < x.size(); ++c) {
            const Vec3 force = sim::unpadded(gradient[c]);
            CHECK(force == sim::unpadded(expected[c]));
            ++(force.norm() > 0 ? n_touched : n_free);
        }
        x = x_end;
    }
    CHECK(n_touched > 300);
    CHECK(n_free > 300);
}

}  // namespace

TEST_CASE("what was seen of corners that were far changes nothing when they touch") {
    for (const Start& start : starts(rough))
        check_followed(start, 0, edge);
}

TEST_CASE("what was seen of corners far off a moving shape that is sampled changes nothing") {
    Collider moving{sampled_sphere, rough};
    moving.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {2, {0.2, 0, 0.1}, {0, 1, 2}}};
    for (const double outside : {-half_a_domain, 0.0, half_a_domain})
        check_followed(
            {moving, sphere.center + 0.5 * Vec3(1, 1, 1).normalized()}, outside, coarse);
}

TEST_CASE("a step ends before a thin plate that moves at a corner could pass it") {
    // At rest 0.1 m above a plate of 0.02 m that comes up at 20 m/s: the gap over the speed, or a share of the thickness where
    // they nearly touch. The corner's own speed adds.
    Collider plate{assets::Box{{-1, -1, -0.02}, {1, 1, 0}}, {}};
    plate.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {1, {0, 0, 20}, {0, 0, 0}}};
    const auto longest = [&](double height, double speed) {
        ColliderContact contact = contact_of(plate);
        const Field x{sim::padded(Vec3(0, 0, height))}, v{sim::padded(Vec3(0, 0, speed))};
        contact.begin_step(x, at_rest, 0, 0.1);
        return contact.largest_step(x, v, 0, 0.1);
    };
    CHECK(longest(0.1, 0) == Approx(0.1 / 20));
    CHECK(longest(0.1, -5) == Approx(0.1 / 25));
    CHECK(longest(1e-4, 0) == Approx(0.4 * 0.02 / 20));
    CHECK(longest(0.1, 20) > 1);  // as fast as the plate
}
