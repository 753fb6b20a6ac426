#include "sim/contact/collider_contact.h"
#include "tests/support/random_fields.h"

#include <catch2/catch.hpp>

using sim::Collider;
using sim::ColliderContact;
using sim::Field;

// What is listed as near must not show: all is compared with every corner against every collider.

namespace {

constexpr double stiffness = 3e4, edge = 0.1, dt = 0.01;
constexpr double least_depth = 1e-3;  // of stops, in domain edges
const sim::Friction smooth{false, 0};
const sim::PlaneShape ground{{0, 0, 0}, {0, 0, 1}};
const std::vector<double> at_rest{0};  // top speeds

/// Colliders and corners, one contact that has followed all steps, and one that has followed them as drifts.
struct Followed {
    std::vector<Collider> colliders;
    std::vector<sim::ContactCorner> corners;
    std::vector<sim::MovingCollider> all;
    ColliderContact contact, drifting;
    Field x_before;

    Followed(const std::vector<Collider>& of, std::size_t n_corners)
        : colliders(of),
          corners(corners_of(n_corners)),
          contact(of, corners),
          drifting(contact) {
        for (const Collider& collider : of)
            all.emplace_back(collider, edge);
    }

    static std::vector<sim::ContactCorner> corners_of(std::size_t n) {
        std::vector<sim::ContactCorner> corners;
        for (std::size_t c = 0; c < n; ++c)
            corners.push_back({static_cast<int>(c), 0, 0, stiffness, 0, edge});
        return corners;
    }

    struct Depth {
        double depth = 0;
        Vec3 normal{0, 0, 0};
    };

    double gap(int j, const Vec3& x, double time) const {
        return all[j].distance(all[j].pose(time).bring_back(x)).gap;
    }

    /// At the end of the step from `time`, out to the side of the start.
    Depth depth(int j, const Vec3& x_n, const Vec3& x_end, double time) const {
        const sim::Pose from = all[j].pose(time), to = all[j].pose(time + dt);
        const auto start = all[j].distance(from.bring_back(x_n)),
                   end = all[j].distance(to.bring_back(x_end));
        const Vec3 n_start = to.R * start.normal, n_end = to.R * end.normal;
        if (n_start.dot(n_end) >= 0)
            return {std::max(0.0, -end.gap), n_end};
        const Vec3 way = x_end - to.carry(from.bring_back(x_n));
        return {std::max(0.0, -(start.gap + n_start.dot(way))), n_start};
    }

    /// Checks what the step from x_n to x_end does; returns its energy there.   [J]
    double check_step(const Field& x_n, const Field& x_end, double time) {
        double energy = 0;
        bool has_changed = false;
        std::vector<double> depths;
        Field v(x_n.size());
        for (std::size_t c = 0; c < x_n.size(); ++c) {
            const Vec3 from = sim::unpadded(x_n[c]);
            v[c] = (x_end[c] - x_n[c]) / dt;
            for (int j = 0; j < static_cast<int>(all.size()); ++j) {
                const double d = depth(j, from, sim::unpadded(x_end[c]), time).depth;
                energy += stiffness / 2 * d * d;
                has_changed = has_changed || (d > 0) != (gap(j, from, time) < 0);
                const Vec3 to = sim::unpadded(x_n[c] + dt * v[c]);
                if (const double left = depth(j, from, to, time).depth;
                    left > least_depth * edge)
                    depths.push_back(left);
            }
        }
        contact.begin_step(x_n, at_rest, time, dt);
        Field gradient(x_n.size()), diagonal(x_n.size());
        CHECK(contact.add_gradient(x_end, gradient) == energy);
        CHECK(contact.has_changed_touch(x_end) == has_changed);
        contact.linearize(x_end);
        contact.add_diagonal(diagonal);
        CHECK((tests::dot(diagonal, diagonal) > 0) == (energy > 0));
        check_stops(contact, x_n, v, depths);
        drifting.begin_drift(
            x_n, x_before.empty() ? 0 : tests::largest_difference(x_n, x_before), time, dt);
        check_stops(drifting, x_n, v, depths);
        x_before = x_n;
        return energy;
    }

    /// v counts at those that touch alone.
    static void check_stops(const ColliderContact& contact,
                            const Field& x_n,
                            const Field& v,
                            const std::vector<double>& depths) {
        const double way = dt * tests::longest(v);
        Field known(v.size());
        for (const int c : contact.touching(way))
            known[c] = v[c];
        const auto stops = contact.stops(x_n, known, way, least_depth);
        REQUIRE(stops.size() == depths.size());
        for (std::size_t i = 0; i < stops.size(); ++i) {
            const auto& [corner, depth, touch] = stops[i];
            CHECK(depth * edge == Approx(depths[i]).margin(1e-12));
            const Vec3 gone = dt * (sim::unpadded(v[corner]) - touch.carried);
            CHECK(-(touch.gap + touch.normal.dot(gone)) == Approx(depths[i]).margin(1e-12));
        }
    }
};

Field random_places(std::size_t n, tests::Random& random, const Vec3& centre, double size) {
    Field x = tests::random_field(n, random, size);
    for (sim::Vec3p& at : x)
        at += sim::padded(centre);
    return x;
}

}  // namespace

TEST_CASE("a corner that jumps from far off into a collider within a step is met") {
    tests::Random random(1);
    Field x = random_places(50, random, {0, 0, 2}, 0.5);
    x[17] = sim::padded(Vec3(0, 0, 1.45));  // the lowest
    Followed followed({{ground, smooth}, {assets::Box{{3, -1, 1}, {5, 1, 3}}, smooth}}, 50);
    CHECK(followed.check_step(x, x, 0) == 0);
    for (const Vec3& to : {Vec3(0, 0, -1e-3), Vec3(0, 0, -3), Vec3(3.2, 0, 2)})
        for (const int c : {0, 17, 49}) {
            Field x_end = x;
            x_end[c] = sim::padded(to);
            CHECK(followed.check_step(x, x_end, 0) > 0);
        }
}

TEST_CASE("corners that drift to the ground and off again for many steps are met") {
    tests::Random random(2);
    const double speed = GENERATE(0.02, 1.0, 30.0);
    const int n = 60;
    Followed followed({{ground, smooth}}, n);
    Field x = random_places(n, random, {0, 0, 0.6}, 0.5);
    Field v = random_places(n, random, {0, 0, -speed / 2}, speed / 2);
    int n_touched = 0, n_free = 0;
    for (int step = 0; step < 2000; ++step) {
        Field x_end = x;
        for (int c = 0; c < n; ++c) {
            if (x[c][2] < -0.02 || x[c][2] > 1.2)
                v[c][2] = std::copysign(v[c][2], x[c][2] < 0 ? 1.0 : -1.0);
            x_end[c] += dt * v[c];
        }
        ++(followed.check_step(x, x_end, step * dt) > 0 ? n_touched : n_free);
        x = x_end;
    }
    CHECK(n_touched > 100);
    CHECK(n_free > 10);
}

TEST_CASE("a collider that moves meets corners that stand still and were far off") {
    tests::Random random(3);
    // An arm that sweeps around, then a wall that flies.
    Collider arm{assets::Box{{-2, -0.1, -1}, {2, 0.1, 1}}, smooth};
    const double fast = GENERATE(0.2, 1.0, 10.0);
    arm.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {4 / fast, {0, 0, 0}, {0, 0, 3}}};
    Collider wall{assets::Box{{-9, -1, -1}, {-4, 3, 1}}, smooth};
    wall.keys = {{4 / fast, {0, 0, 0}, {0, 0, 0}}, {8 / fast, {8, 0, 0}, {0, 0, 0}}};
    const int n = 60;
    Followed followed({arm, wall}, n);
    const Field x = random_places(n, random, {0, 1.6, 0}, 0.6);
    double arm_energy = 0, wall_energy = 0;
    for (double time = 0; time < 8 / fast; time += dt)
        (time < 4 / fast ? arm_energy : wall_energy) += followed.check_step(x, x, time);
    CHECK(arm_energy > 0);
    CHECK(wall_energy > 0);
}

TEST_CASE("a collider that comes from far off within a step meets corners that stand still") {
    tests::Random random(5);
    Collider wall{assets::Box{{-9, -1, -1}, {-4, 1, 1}}, smooth};
    wall.keys = {{10 * dt, {0, 0, 0}, {0, 0, 0}}, {11 * dt, {8, 0, 0}, {0, 0, 0}}};
    const int n = 60;
    Followed followed({wall}, n);
    const Field x = random_places(n, random, {0, 0, 0}, 0.5);
    double energy = 0;
    for (int step = 0; step < 20; ++step)
        energy += followed.check_step(x, x, step * dt);
    CHECK(energy > 0);
}

TEST_CASE("the longest step to a thin collider is that of the nearest corner, far or near") {
    tests::Random random(4);
    Collider plate{assets::Box{{-5, -5, -0.05}, {5, 5, 0}}, smooth};
    plate.keys = {{0, {0, 0, 0}, {0, 0, 0}},
                  {2, {0, 0, -1}, {0.3, 0, 0}},
                  {2 + dt, {0, 0, 1}, {0.3, 0, 0}}};  // at last from far off within a step
    const int n = 40;
    Followed followed({plate}, n);
    const ColliderContact unused = followed.contact;  // knows of none that is far
    Field x = random_places(n, random, {0, 0, 1.2}, 0.8);
    int n_limited = 0;
    for (int step = 0; step < 300; ++step) {
        const double time = step * dt;
        followed.contact.begin_step(x, at_rest, time, dt);
        for (const double speed : {0.1, 3.0, 100.0}) {
            const Field v = tests::random_field(n, random, speed);
            const double limit = followed.contact.largest_step(x, v, time + dt, dt);
            CHECK(limit == unused.largest_step(x, v, time + dt, dt));
            n_limited += limit < dt;
        }
        for (sim::Vec3p& at : x)
            at += sim::padded(tests::random_vector(random, 0.01));
    }
    CHECK(n_limited > 50);
}
