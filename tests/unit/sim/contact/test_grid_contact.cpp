#include "sim/contact/grid_contact.h"
#include "tests/support/random_fields.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>

using sim::Field;
using sim::Vec3p;

namespace {

constexpr double s = 0.1, dt = 1e-3;
constexpr int n = 4;  // corners along an edge

/// Of corners that are all free, so that they are the degrees of freedom.
bool restrain(sim::GridContact& contact,
              const Field& x,
              const Field& mass,
              const Field& is_free,
              Field& velocity) {
    const int n_corners = static_cast<int>(x.size());
    sim::CornerMap map;
    map.rebuild(x, std::vector<char>(x.size(), 1), {{0, n_corners, s}});
    std::vector<double> inverse_mass;
    for (const Vec3p& m : mass)
        inverse_mass.push_back(1 / m[0]);
    sim::Impulses impulses(map, inverse_mass, is_free);
    Field moved = velocity;
    const bool have_met = contact.restrain(impulses, x, dt, velocity, moved);
    const Field apart = tests::sum(velocity, -1, moved);
    CHECK(tests::dot(apart, apart) < 1e-28);
    return have_met;
}

/// Two cubes of n³ corners side by side along x, with a gap between them.
struct Cubes {
    Field x, mass, velocity, is_free;
    std::vector<double> volume, outside;
    std::vector<sim::ContactBody> bodies{{0, n* n* n}, {n * n * n, 2 * n* n* n}};

    Cubes(double gap,
          const Vec3& v_left,
          const Vec3& v_right,
          const Vec3& offset = {0.013, 0.02, -5.03}) {
        for (int b = 0; b < 2; ++b)
            for (int k = 0; k < n * n * n; ++k) {
                const Vec3 low = offset + b * ((n - 1) * s + gap) * Vec3::UnitX();
                x.push_back(sim::padded(low + s * Vec3(k % n, k / n % n, k / (n * n))));
                mass.push_back(sim::padded(Vec3::Constant(b ? 3 : 1)));
                velocity.push_back(sim::padded(b ? v_right : v_left));
                is_free.push_back(Vec3p{1, 1, 1, 0});
                volume.push_back(s * s * s);
                outside.push_back(0);
            }
    }

    sim::GridContact contact(const sim::Friction& friction) const {
        std::vector<sim::GridPair> pairs;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            for (std::size_t j = i + 1; j < bodies.size(); ++j)
                pairs.push_back({bodies[i], bodies[j], s, friction});
        return {pairs, {x, mass, volume, outside}};
    }

    bool meet(const sim::Friction& friction) {
        sim::GridContact contact = this->contact(friction);
        return restrain(contact, x, mass, is_free, velocity);
    }

    Vec3 momentum(int b) const {
        Vec3 sum = Vec3::Zero();
        for (int c = bodies[b].begin; c < bodies[b].end; ++c)
            sum += sim::unpadded(mass[c] * velocity[c]);
        return sum;
    }

    double kinetic_energy() const {
        double sum = 0;
        for (std::size_t c = 0; c < x.size(); ++c)
            sum += sim::dot(mass[c] * velocity[c], velocity[c]) / 2;
        return sum;
    }

    bool unchanged_from(const Field& before) const {
        for (std::size_t c = 0; c < before.size(); ++c)
            for (int axis = 0; axis < 3; ++axis)
                if (velocity[c][axis] != before[c][axis])
                    return false;
        return true;
    }
};

}  // namespace

TEST_CASE("bodies that overlap and approach exchange momentum exactly, and lose energy") {
    tests::Random random(3);
    for (const sim::Friction& friction :
         {sim::Friction{false, 0}, sim::Friction{false, 0.3}, sim::Friction{true, 0}}) {
        Cubes cubes(-0.02 * s, {2, 0.3, 0}, {0, 0, -0.4});
        for (Vec3p& v : cubes.velocity)
            v += sim::padded(tests::random_vector(random, 0.2));
        const Vec3 left = cubes.momentum(0), right = cubes.momentum(1);
        const double energy = cubes.kinetic_energy();
        cubes.meet(friction);
        CHECK((cubes.momentum(0) + cubes.momentum(1) - left - right).norm()
              <= 1e-13 * left.norm());
        CHECK(cubes.momentum(0).x() < 0.9 * left.x());
        CHECK(cubes.kinetic_energy() < 0.999 * energy);
    }
}

TEST_CASE("bodies that stay apart, or part, are left alone") {
    const double closing = 2 * dt;  // of 2 m/s in a step [m]
    const auto changes = [](Cubes cubes) {
        const Field before = cubes.velocity;
        const bool has_met = cubes.meet({true, 0});
        CHECK(has_met == !cubes.unchanged_from(before));
        return has_met;
    };
    CHECK(changes({0.5 * closing, {2, 0, 0}, {0, 0, 0}}));
    CHECK(!changes({1.5 * closing, {2, 0, 0}, {0, 0, 0}}));  // they do not meet within the step
    CHECK(!changes({100 * s, {2, 0, 0}, {0, 0, 0}}));
    CHECK(!changes({-0.01 * s, {0, 0.5, 0}, {2, 0, 0}}));  // overlapping, but parting
    CHECK(!changes({-0.01 * s, {1, 1, 1}, {1, 1, 1}}));

    Cubes covered(0.5 * closing,
                  {2, 0, 0},
                  {0, 0, 0});  // corners that stick out of the body do not touch
    covered.outside.assign(covered.x.size(), closing);
    CHECK(!changes(covered));
}

TEST_CASE(
    "without friction the tangential momentum stays, with it mu times the normal impulse goes "
    "over") {
    const auto impulses = [](const sim::Friction& friction) {
        Cubes cubes(-0.02 * s, {2, 3, 0}, {0, 0, 0});
        const Vec3 before = cubes.momentum(0);
        cubes.meet(friction);
        return Vec3(before - cubes.momentum(0));
    };
    const Vec3 slip = impulses({false, 0}), rough = impulses({false, 0.2}),
               stick = impulses({true, 0});
    REQUIRE(slip.x() > 1);
    CHECK(std::abs(slip.y()) <= 1e-12 * slip.x());
    CHECK(rough.y() == Approx(0.2 * rough.x()).epsilon(1e-10));
    CHECK(stick.y() > rough.y());
    for (const Vec3& impulse : {slip, rough, stick})
        CHECK(std::abs(impulse.z()) <= 1e-12 * impulse.x());
}

TEST_CASE("a block that slides on a plate is pushed off its face, not along it") {
    // The plate lies on the nodes, but for a breath: to which side of a node a corner is must not matter.
    constexpr int wide = 12;
    tests::Random random(4);
    Field x, mass, velocity, is_free;
    std::vector<double> volume, outside;
    const auto add = [&](const Vec3& position, const Vec3& v) {
        x.push_back(sim::padded(position + tests::random_vector(random, 1e-6 * s)));
        mass.push_back(sim::padded(Vec3::Ones()));
        volume.push_back(s * s * s);
        velocity.push_back(sim::padded(v));
        is_free.push_back(Vec3p{1, 1, 1, 0});
        outside.push_back(0);
    };
    for (int k = 0; k < wide * wide * 3; ++k)
        add(s * Vec3(k % wide, k / wide % wide, k / (wide * wide) - 2), {0, 0, 0});
    const double aside = GENERATE(0.0, 0.3), overlap = 1e-3 * s;
    const int plate = static_cast<int>(x.size());
    for (int k = 0; k < n * n * n; ++k)
        add(s * Vec3(4 + aside + k % n, 4 + aside + k / n % n, k / (n * n))
                - overlap * Vec3::UnitZ(),
            {1, 0.5, -0.1});
    const int end = static_cast<int>(x.size());
    const Field before = velocity;
    const double mu = GENERATE(0.0, 0.1);
    sim::GridContact contact({{{0, plate}, {plate, end}, s, {false, mu}}},
                             {x, mass, volume, outside});
    restrain(contact, x, mass, is_free, velocity);
    Vec3 impulse = Vec3::Zero();
    for (int c = plate; c < end; ++c)
        impulse += sim::unpadded(velocity[c] - before[c]);
    const Vec3 along = Vec3(1, 0.5, 0).normalized();
    CAPTURE(aside, mu, impulse.transpose());
    REQUIRE(impulse.z() > 0.1);
    CHECK(-impulse.dot(along) == Approx(mu * impulse.z()).margin(0.01 * impulse.z()));
    CHECK(std::abs(impulse.cross(along).z()) < 0.01 * impulse.z());
}

TEST_CASE("sticking bodies do not slide where they touch") {
    Cubes cubes(-0.02 * s, {2, 3, 0}, {0, 0, 0});
    cubes.meet({true, 0});
    // The facing corners of both cubes move alike, up to what the grid's interpolation leaves.
    const int facing = n - 1 + n * (1 + n), other = n * n * n + n * (1 + n);
    const Vec3 relative = sim::unpadded(cubes.velocity[facing] - cubes.velocity[other]);
    CHECK(relative.norm() < 0.2 * Vec3(2, 3, 0).norm());
}

TEST_CASE("prescribed components keep their velocity") {
    Cubes cubes(-0.02 * s, {2, 0, 0}, {0, 0, 0});
    const Field before = cubes.velocity;
    cubes.is_free.assign(cubes.x.size(), Vec3p{0, 1, 1, 0});
    cubes.meet({false, 0});
    for (std::size_t c = 0; c < before.size(); ++c)
        CHECK(cubes.velocity[c][0] == before[c][0]);
}

TEST_CASE("each pair of several bodies meets, and none is fine too") {
    Cubes cubes(-0.02 * s, {2, 0, 0}, {-1, 0, 0});
    const Field before = cubes.velocity;
    cubes.bodies.clear();
    cubes.meet({});
    CHECK(cubes.unchanged_from(before));
    // Far body first: the meeting pair is the second and third.
    Cubes three(-0.02 * s, {2, 0, 0}, {-1, 0, 0});
    const Vec3 sum = three.momentum(0) + three.momentum(1);
    const int end = 2 * n * n * n;
    for (int c = 0; c < 8; ++c) {
        three.x.push_back(Vec3p{50.0 + c, 50, 50, 0});
        three.mass.push_back(Vec3p{1, 1, 1, 0});
        three.velocity.push_back(Vec3p{1, 1, 1, 0});
        three.is_free.push_back(Vec3p{1, 1, 1, 0});
        three.volume.push_back(s * s * s);
        three.outside.push_back(0);
    }
    three.bodies.insert(three.bodies.begin(), {end, end + 8});
    three.meet({});
    CHECK(three.velocity[end][0] == 1);
    CHECK((three.momentum(1) + three.momentum(2) - sum).norm() <= 1e-13 * 200);
    CHECK(three.momentum(1).x() < 2 * n * n * n * 0.95);
}
