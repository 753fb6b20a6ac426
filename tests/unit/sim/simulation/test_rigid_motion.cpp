#include "sim/rigid_motion.h"
#include "tests/support/random_fields.h"

#include <catch2/catch.hpp>

#include <functional>

using sim::Field;

namespace {

constexpr double thin = 1e-3;

Field filled(int n, const std::function<Vec3(int)>& value) {
    Field field;
    for (int c = 0; c < n; ++c)
        field.push_back(sim::padded(value(c)));
    return field;
}

}  // namespace

TEST_CASE(
    "the rigid motion of masses that move rigidly is their motion, about principal axes or "
    "not") {
    tests::Random random(4);
    const int n = 30;
    const Field x = filled(n, [&](int) { return tests::random_vector(random); }),
                m = filled(n, [&](int) {
                    return Vec3::Constant(1.5 + tests::random_vector(random).x()).eval();
                });
    const Vec3 velocity(1, 2, 3), spin(-3, 0.5, 2);
    const Field v =
        filled(n, [&](int c) { return (velocity + spin.cross(sim::unpadded(x[c]))).eval(); });
    const sim::RigidMotion rigid = sim::rigid_motion(m, x, v, 0, n, thin);
    CHECK((sim::unpadded(rigid.spin) - spin).norm() < 1e-13);
    for (int c = 0; c < n; ++c)
        CHECK((sim::unpadded(rigid.at(x[c])) - sim::unpadded(v[c])).norm() < 1e-13);
}

TEST_CASE("masses in a row turn with their angular momentum across it, and not about it") {
    const int n = 10;
    const Vec3 along = Vec3(1, 2, -2) / 3, across = Vec3(2, 1, 2) / 3;
    const auto place = [&](int c) { return (Vec3(5, 6, 7) + 0.1 * c * along).eval(); };
    const Field x = filled(n, place), m = filled(n, [](int) { return Vec3(2, 2, 2); });
    for (const double speed : {0.0, 3.0}) {
        const Field v = filled(n, [&](int c) {
            return (Vec3(100, -50, 25) + (speed * across).cross(place(c))).eval();
        });
        const sim::RigidMotion rigid = sim::rigid_motion(m, x, v, 0, n, thin);
        CHECK((sim::unpadded(rigid.spin) - speed * across).norm() < 1e-11);
    }
}
