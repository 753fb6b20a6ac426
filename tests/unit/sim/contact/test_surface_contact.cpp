#include "sim/contact/contact_search.h"
#include "sim/contact/surface_contact.h"
#include "tests/support/box_body.h"
#include "tests/support/derivative_order.h"
#include "tests/support/random_fields.h"

#include <catch2/catch.hpp>

#include <cmath>

using sim::Field;

namespace {

constexpr double edge = 0.05, dt = 1e-3, top = 3 * edge;
constexpr double young_modulus = 1e6;  // of box_body

/// A small block that is let down on a big one; both stay as they are at rest, or are bent a little.
struct Blocks {
    sim::Body small = tests::box_body({2, 2, 2}, edge, {1.1 * edge, 1.2 * edge, top}),
              big = tests::box_body({4, 4, 3}, edge);
    sim::Lattice of_small = sim::make_lattice(small), of_big = sim::make_lattice(big);
    int n_small = of_small.n_corners();
    sim::ContactSurface upper{small, of_small, 0, 0}, lower{big, of_big, n_small, 1};
    sim::SurfaceContact contact;
    std::vector<double> still{0, 0};

    explicit Blocks(const sim::Friction& friction)
        : contact({upper, lower}, sim::PairFriction(scene(friction)), 1) {}

    static sim::Scene scene(const sim::Friction& friction) {
        sim::Scene scene;
        for (const char* name : {"small", "big"}) {
            scene.bodies.emplace_back();
            scene.bodies.back().name = name;
        }
        scene.contact.friction = friction;
        return scene;
    }

    /// The small one moved, corners of both out of place by up to `bent`.
    Field at(const Vec3& moved, double bent = 0) const {
        tests::Random random(11);
        Field x;
        for (const Vec3& X : of_small.corner_rest)
            x.push_back(sim::padded(X + moved + tests::random_vector(random, bent)));
        for (const Vec3& X : of_big.corner_rest)
            x.push_back(sim::padded(X + tests::random_vector(random, bent)));
        return x;
    }

    void step(const Field& x,
              const Field& x_expected,
              std::vector<sim::HeldContact> held = {}) {
        Field v(x.size());
        for (std::size_t c = 0; c < x.size(); ++c)
            v[c] = (x_expected[c] - x[c]) / dt;
        contact.see({x, v, still, held});
        contact.begin_step({x, v, still, held}, x_expected, dt);
    }

    /// k of a vertex that touches.   [N/m]
    double stiffness(const sim::HeldContact& held) const {
        const sim::ContactSurface& surface = held.pair == 1 ? upper : lower;
        return 40 * young_modulus * surface.vertices[held.vertex].area / edge;
    }

    double energy(const Field& x) const {
        Field g(x.size());
        return contact.add_gradient(x, g);
    }

    Field gradient(const Field& x) const {
        Field g(x.size());
        contact.add_gradient(x, g);
        return g;
    }

    Field product(const Field& u) const {
        Field result(u.size());
        contact.add_product(u, result);
        return result;
    }
};

Vec3 total(const Field& field) {
    sim::Vec3p sum{};
    for (const sim::Vec3p& f : field)
        sum += f;
    return sim::unpadded(sum);
}

Vec3 moment(const Field& x, const Field& force) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < x.size(); ++c)
        sum += sim::unpadded(x[c]).cross(sim::unpadded(force[c]));
    return sum;
}

double magnitude(const Field& field) {
    return std::sqrt(tests::dot(field, field));
}

constexpr double bent = 0.02 * edge, deep = 0.08 * edge;

/// Bent, pressed together since the step before and sliding over each other now.
Field press_and_slide(Blocks& blocks, double slip) {
    const Field apart = blocks.at({0, 0, 2 * bent}, bent),
                pressed = blocks.at({0, 0, -deep}, bent),
                x = blocks.at({slip, 0.4 * slip, -1.2 * deep}, bent);
    blocks.step(apart, pressed);
    blocks.step(pressed, x, blocks.contact.held(pressed));
    return x;
}

}  // namespace

TEST_CASE("the energy of contact is k/2 d² of every vertex inside, k = 40 E A / s") {
    Blocks blocks({false, 0.3});
    const Field apart = blocks.at({0, 0, edge / 10}), x = blocks.at({0, 0, -deep});
    blocks.step(apart, x);
    const auto energy_in = [&](const sim::ContactSurface& vertices,
                               const sim::ContactSurface& domains) {
        double sum = 0;
        for (const sim::ContactPoint& contact :
             sim::find_contacts(vertices, vertices.all_vertices(), domains, x, apart, 0.0))
            sum += 40 * young_modulus * contact.vertex->area / edge * contact.gap * contact.gap
                   / 2;
        return sum;
    };
    double of_upper = 0;  // all of one depth in the middle of the big one's top
    for (const sim::ContactVertex& vertex : blocks.upper.vertices)
        if (const double depth = top - vertex.position(x).z(); depth > 0)
            of_upper += 40 * young_modulus * vertex.area / edge * depth * depth / 2;
    REQUIRE(of_upper > 1);
    CHECK(energy_in(blocks.upper, blocks.lower)
          == Approx(of_upper).epsilon(1e-3));  // distances are of float
    CHECK(blocks.energy(x)
          == Approx(energy_in(blocks.upper, blocks.lower)
                    + energy_in(blocks.lower, blocks.upper)));
    double held = 0;
    for (const sim::HeldContact& vertex : blocks.contact.held(x))
        held += vertex.energy;
    CHECK(held == Approx(blocks.energy(x)));
    CHECK(blocks.energy(blocks.at({0, 0, 0.01 * edge})) == 0);
}

TEST_CASE("forces of contact are the slope of its energy, and its Hessian their change") {
    Blocks blocks({false, 0.4});
    // Slips grow to 3 mm/s: above the spring's end.
    const Field x = press_and_slide(blocks, 3e-6);
    blocks.contact.linearize(x);
    blocks.contact.linearize(x);  // friction's Hessian is its own when its direction is known
    REQUIRE(magnitude(blocks.gradient(x)) > 1);
    tests::Random random(5);
    const Field way = tests::random_field(x.size(), random);
    // Friction bends within 1e-6 m; touch begins and ends further off than that.
    const auto slope_error = [&](double h) {
        const Field ahead = tests::sum(x, h, way), behind = tests::sum(x, -h, way);
        return (blocks.energy(ahead) - blocks.energy(behind)) / (2 * h)
               - tests::dot(blocks.gradient(x), way);
    };
    const auto curvature_error = [&](double h) {
        const Field ahead = blocks.gradient(tests::sum(x, h, way)),
                    behind = blocks.gradient(tests::sum(x, -h, way));
        const Field change = tests::sum(ahead, -1, behind);
        return magnitude(tests::sum(blocks.product(way), -1 / (2 * h), change));
    };
    CHECK(tests::observed_order(slope_error, 3e-7) > 1.8);
    CHECK(tests::observed_order(curvature_error, 3e-7) > 1.8);
}

TEST_CASE("the Hessian of contact is symmetric, not negative, and has its own diagonal") {
    Blocks blocks({false, 0.4});
    const Field x = press_and_slide(blocks, 3e-6);
    blocks.contact.linearize(x);
    tests::Random random(8);
    const Field u = tests::random_field(x.size(), random),
                w = tests::random_field(x.size(), random);
    const double uHw = tests::dot(u, blocks.product(w));
    CHECK(tests::dot(w, blocks.product(u)) == Approx(uHw).epsilon(1e-10));
    CHECK(tests::dot(u, blocks.product(u)) > 0);
    Field diagonal(x.size());
    blocks.contact.add_diagonal(diagonal);
    for (std::size_t c = 0; c < x.size(); c += 7)
        for (int k = 0; k < 3; ++k) {
            Field unit(x.size());
            unit[c][k] = 1;
            CHECK(diagonal[c][k] == Approx(blocks.product(unit)[c][k]));
        }
}

TEST_CASE("forces of contact balance, and turn nothing where they are linearised") {
    Blocks blocks({false, 0.4});
    const Field x = press_and_slide(blocks, 3e-6), force = blocks.gradient(x);
    CHECK(total(force).norm() < 1e-12 * magnitude(force));
    CHECK(moment(x, force).norm() < 1e-9 * top * magnitude(force));
    // On the small block: up, and against its way by no more than mu as much.
    const Vec3 on_small = -total({force.begin(), force.begin() + blocks.n_small});
    CHECK(on_small.z() > 0);
    CHECK(on_small.x() < 0);
    CHECK(on_small.head<2>().norm() < 0.4 * on_small.z() + 0.05 * on_small.z());
}

TEST_CASE("a step starts with no more energy of contact than the one before has left") {
    Blocks blocks({false, 0});
    const Field apart = blocks.at({0, 0, deep}), pressed = blocks.at({0, 0, -deep});
    blocks.step(apart, pressed);
    const double left = blocks.energy(pressed), returned = dt * 0.1 * edge;
    std::vector<sim::HeldContact> held = blocks.contact.held(pressed);
    blocks.step(pressed, pressed, held);
    // A gap that had to be shifted comes back by 0.1 edges a second. Near a rim a vertex may be less deep under the nearest
    // face than under the one it came through.
    CHECK(blocks.energy(pressed) > 0.95 * left);
    CHECK(blocks.energy(pressed) <= left * std::pow(1 + returned / (0.5 * deep), 2));
    // As deep, but with a quarter of the energy left.
    for (sim::HeldContact& vertex : held)
        vertex.energy /= 4;
    blocks.step(pressed, pressed, held);
    CHECK(blocks.energy(pressed) > 0.95 * left / 4);
    CHECK(blocks.energy(pressed) <= left / 4 * std::pow(1 + returned / (0.25 * deep), 2));
    // Nothing was seen before: a start inside is no store of energy.
    blocks.step(pressed, pressed);
    double allowed = 0;
    for (const sim::HeldContact& vertex : blocks.contact.held(pressed))
        allowed += blocks.stiffness(vertex) * returned * returned / 2;
    CHECK(blocks.energy(pressed) == Approx(allowed));
    CHECK(blocks.energy(pressed) < 1e-4 * left);
}

TEST_CASE("explicit contact takes what would end inside, keeps momentum and makes no energy") {
    // Corners of the big block free, of the small one free, or moved by a grid, which lets part of an impulse through.
    const double mu = GENERATE(0.0, 0.3);
    const bool is_slaved = GENERATE(false, true);
    CAPTURE(mu, is_slaved);
    Blocks blocks({false, mu});
    const Field x = blocks.at({0, 0, 0.01 * edge}, 0);
    const int n_corners = static_cast<int>(x.size());
    std::vector<char> free(x.size(), 1);
    std::fill(free.begin(), free.begin() + blocks.n_small, !is_slaved);
    sim::CornerMap map;
    map.rebuild(
        x, free, {{0, blocks.n_small, 2 * edge}, {blocks.n_small, n_corners, 2 * edge}});
    Field mass(map.n_dofs()), q(map.n_dofs());
    map.apply_transposed(Field(x.size(), sim::padded(Vec3::Constant(0.1))), mass);
    const Field is_free(map.n_dofs(), sim::padded(Vec3::Ones()));
    std::vector<double> inverse_mass;
    const Vec3 velocity(3, 1, -0.05 * edge / dt);
    for (int i = 0; i < map.n_dofs(); ++i) {
        inverse_mass.push_back(1 / mass[i][0]);
        if (map.dof_body()[i] == 0)
            q[i] = sim::padded(velocity);
    }
    const auto end = [&](const Field& velocities) {
        Field v(x.size());
        map.apply(velocities, v);
        return tests::sum(x, dt, v);
    };
    Field v(x.size());
    map.apply(q, v);
    blocks.contact.see({x, v, blocks.still, {}});
    blocks.contact.begin_step({x, v, blocks.still, {}}, end(q), dt);
    const double before = blocks.energy(end(q));
    REQUIRE(before > 0);
    Field after = q;
    sim::Impulses impulses(map, inverse_mass, is_free);
    REQUIRE(blocks.contact.restrain(impulses, after, v));
    const Field missed = tests::sum(tests::sum(x, dt, v), -1, end(after));
    CHECK(tests::dot(missed, missed) < 1e-28);
    // What stays of a depth, 1e-4 edges, is 400 times less than they would have got in.
    CHECK(blocks.energy(end(after)) < 1e-5 * before);
    const auto momentum = [&](const Field& velocities, int body) {
        Vec3 sum = Vec3::Zero();
        for (int i = 0; i < map.n_dofs(); ++i)
            if (body < 0 || map.dof_body()[i] == body)
                sum += sim::unpadded(mass[i] * velocities[i]);
        return sum;
    };
    const auto kinetic = [&](const Field& velocities) {
        double sum = 0;
        for (int i = 0; i < map.n_dofs(); ++i)
            sum += sim::dot(mass[i] * velocities[i], velocities[i]) / 2;
        return sum;
    };
    CHECK((momentum(after, -1) - momentum(q, -1)).norm() < 1e-12 * momentum(q, -1).norm());
    CHECK(kinetic(after) < kinetic(q));
    // Friction takes at most mu of the impulse along the normal, against the slip.
    const Vec3 impulse = momentum(after, 0) - momentum(q, 0);
    CHECK(impulse.z() > 0);
    CHECK(-impulse.x()
          == Approx(mu * impulse.z() * velocity.x() / velocity.head<2>().norm())
                 .epsilon(1e-2)
                 .margin(1e-12));
}

TEST_CASE("a linearisation is called linear enough only where a new one differs by less") {
    Blocks blocks({false, 0.3});
    tests::Random random(5);
    const double tolerance = 1e-4;
    int n_enough = 0, n_looked_at = 0, n_not = 0;
    for (int k = 0; k < 400; ++k) {
        const double size = edge * std::pow(10.0, -5 + 4 * (k % 40) / 40.0);
        const Field apart = blocks.at({0, 0, 0.01 * edge}, bent),
                    x = blocks.at({0, 0, -0.005 * edge}, bent);
        // All slides, and every corner goes a little by itself.
        Field x_next = x;
        const Vec3 slip = tests::random_vector(random, size);
        double way = 0;
        for (std::size_t c = 0; c < x.size(); ++c) {
            const Vec3 u = tests::random_vector(random, 0.3 * size)
                           + (static_cast<int>(c) < blocks.n_small ? slip : Vec3(0, 0, 0));
            x_next[c] += sim::padded(u);
            way = std::max(way, u.norm());
        }
        blocks.step(apart, x);
        const bool is_enough = blocks.contact.is_linear_enough(x_next, way, tolerance);
        const double differs = blocks.contact.relinearize(x_next);
        CAPTURE(size / edge, differs);
        if (is_enough)
            CHECK(differs < tolerance);
        else
            CHECK((differs >= tolerance || size > 5e-3 * edge));
        n_enough += is_enough;
        n_looked_at += is_enough && size > tolerance * edge;
        n_not += differs >= tolerance;
    }
    CHECK(n_enough > 100);
    CHECK(n_looked_at > 20);
    CHECK(n_not > 20);
}

TEST_CASE("what is told of bodies apart or in each other is in domain edges") {
    Blocks blocks({});

    struct Place {
        double above;  // [domain edges]
        double penetration, gap;
    };

    for (const auto& [above, penetration, gap] :
         {Place{0.3, 0, 0.3}, Place{-0.1, 0.1, 0}, Place{2, 0, 1}, Place{0, 0, 0}}) {
        const auto report = blocks.contact.report(blocks.at({0, 0, above * edge}));
        CAPTURE(above);
        CHECK(report.penetration == Approx(penetration).margin(1e-9));
        CHECK(report.gap == Approx(gap).margin(1e-9));
    }
}
