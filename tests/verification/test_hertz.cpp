// A ball pressed and thrown against a plane and against another: Hertz's law, rebound, energy and depth.
#include "tests/support/soft_block.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

constexpr double pi = std::numbers::pi, frame_time = 1.0 / 24;
constexpr double R = 0.1, E = 1e6, nu = 0.3, density = 1000;  // [m], [Pa], [–], [kg/m³]
constexpr double mass = 4 * pi / 3 * R * R * R * density;

/// Hertz's law of a ball on a rigid, frictionless plane, or of one of two equal balls on the plane between them: the
/// centre of mass comes nearer by
///
///     delta(F) = (F/k)^(2/3) - c F / (E R),   k = 4/3 E sqrt(R) / (1 - nu²).
///
/// The second term is the first correction for a ball that is no half-space: its body is carried by forces spread over its
/// volume. c is that of a contact of a/R = 0.2 (correction_of_ball()).
struct Law {
    double c = 0.344;

    static double stiffness() { return 4.0 / 3 * E / (1 - nu * nu) * std::sqrt(R); }

    double approach(double F) const {
        return std::pow(F / stiffness(), 2.0 / 3) - c * F / (E * R);
    }

    double force(double delta) const {
        double low = 0, high = 1000;
        for (int k = 0; k < 60; ++k) {
            const double middle = (low + high) / 2;
            (approach(middle) < delta ? low : high) = middle;
        }
        return low;
    }
};

/// (a²/R - delta) E R/F of a ball of R = E = 1 that Hertz's pressure on a patch of radius a presses, and a uniform body force
/// carries: delta is how much nearer its centre of mass comes to the middle of the patch. By Legendre polynomials: of a pressure
/// -p_n P_n(cos θ) the surface moves by p_n (n A + (n + 1)(n - 2 + 4 nu) B) P_n outwards, where
///
///     B = -1 / (4 mu (n² + n + 1 + nu (2n + 1))),   A = -B (n² + 2n - 1 + 2 nu) / (n - 1)
///
/// make the shear stress vanish (Lur'e, Three-Dimensional Problems of the Theory of Elasticity, 1964); n = 0 is a uniform
/// pressure, and n = 1 the body force.
double correction_of_ball(double a) {
    constexpr int n_terms = 3000, n_rings = 4000;
    constexpr double mu = 1 / (2 * (1 + nu)), lambda = nu / ((1 + nu) * (1 - 2 * nu));

    struct Ring {
        double pressure, cosine, width, before, now;  // P_(n-1) and P_n there
    };

    std::vector<Ring> rings;
    double force = 0;
    for (int k = 0; k < n_rings; ++k) {
        const double t = (k + 0.5) / n_rings * pi / 2, sine = a * std::sin(t),
                     cosine = std::sqrt(1 - sine * sine),
                     width = sine * a * std::cos(t) / cosine * pi / 2 / n_rings;
        rings.push_back({std::cos(t), cosine, width, 0, 1});
        force += 2 * pi * rings.back().pressure * cosine * width;
    }
    double moved = 0;
    for (int n = 0; n < n_terms; ++n) {
        double p = 0;
        for (Ring& ring : rings) {
            p -= (2 * n + 1) / 2.0 * ring.pressure * ring.now * ring.width;
            const double next =
                ((2 * n + 1) * ring.cosine * ring.now - n * ring.before) / (n + 1);
            ring.before = ring.now;
            ring.now = next;
        }
        const double B = -1 / (4 * mu * (n * n + n + 1 + nu * (2 * n + 1)));
        if (n == 0)
            moved += p * (1 - 2 * nu) / (2 * mu * (1 + nu));
        else if (
            n
            == 1)  // u_z = C (r² - 2z²) where stresses balance it: C at the pole less C/5 in the mean
            moved += p * 6 / (5 * (6 * lambda + 4 * mu));
        else
            moved += p
                     * (-B * (n * n + 2 * n - 1 + 2 * nu) / (n - 1) * n
                        + B * (n + 1) * (n - 2 + 4 * nu));
    }
    const double of_hertz = 4 * a * a * a / (3 * (1 - nu * nu)), scale = of_hertz / force;
    return (a * a + moved * scale) / of_hertz;
}

/// The largest approach and force, and the time from touch to touch, of an impact at `speed`: m x'' = -F(x).
struct Impact {
    double approach = 0, force = 0, duration = 0;

    Impact() = default;

    Impact(const Law& law, double speed) {
        constexpr double dt = 2e-5;
        for (double x = 0, v = speed; x >= 0; x += dt * v, duration += dt) {
            const double F = law.force(x);
            force = std::max(force, F);
            approach = std::max(approach, x);
            v -= dt * F / mass;
        }
    }
};

/// The quarter x > 0, y > 0 of a ball as a closed mesh file.
std::filesystem::path quarter_ball(const std::string& name, const Vec3& centre) {
    constexpr int n = 96, m = n / 2;  // facets from pole to pole, and across the quarter
    const auto path = std::filesystem::temp_directory_path()
                      / ("supple_hertz_" + name + "_" + std::to_string(::getpid()) + ".obj");
    std::ofstream file(path);
    const auto vertex = [&](const Vec3& unit) {
        file << "v " << (centre + R * unit).transpose() << "\n";
    };
    vertex({0, 0, 0});
    vertex({0, 0, 1});
    vertex({0, 0, -1});
    for (int i = 1; i < n; ++i)
        for (int j = 0; j <= m; ++j) {
            const double theta = pi * i / n, phi = pi / 2 * j / m, out = std::sin(theta);
            vertex({j == m ? 0 : out * std::cos(phi),
                    j == 0 ? 0 : out * std::sin(phi),
                    std::cos(theta)});
        }
    const auto at = [&](int i, int j) {
        return i == 0 ? 2 : i == n ? 3 : 4 + (i - 1) * (m + 1) + j;
    };
    const auto triangle = [&](int a, int b, int c) {
        file << "f " << a << " " << b << " " << c << "\n";
    };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < m; ++j) {
            if (i > 0)
                triangle(at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + 1 < n)
                triangle(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
        }
        triangle(1, at(i + 1, 0), at(i, 0));
        triangle(1, at(i, m), at(i + 1, m));
    }
    return path;
}

/// Quarter balls between planes of symmetry: "upper" above the plane z = 0 by `gap`, and either that plane or its mirror
/// image.
struct Press {
    sim::Scene scene;

    Press(double edge, double gap, bool has_lower) {
        scene.solver.method = sim::Method::Fem;
        scene.solver.steps = sim::Steps::Bdf2;
        scene.solver.dt = 0.5e-3;
        add("upper", {0, 0, R + gap}, edge);
        if (has_lower)
            add("lower", {0, 0, -R - gap}, edge);
        else
            scene.colliders.push_back({sim::PlaneShape{{0, 0, 0}, {0, 0, 1}}, {false, 0}});
        scene.probes = {{"upper", "upper", std::string("all")}};
    }

    Press(const Press&) = delete;
    Press& operator=(const Press&) = delete;

    ~Press() {
        for (const sim::Body& body : scene.bodies)
            std::filesystem::remove(std::get<assets::MeshFile>(body.source.geometry).path);
    }

  private:
    void add(const std::string& name, const Vec3& centre, double edge) {
        sim::Body body = tests::soft_body(name.c_str(), assets::Sphere{centre, R}, edge, E);
        body.source.geometry = assets::MeshFile{quarter_ball(name, centre)};
        scene.bodies.push_back(body);
        for (int axis = 0; axis < 2; ++axis) {
            sim::Pin pin;
            pin.name = name + (axis ? "_y" : "_x");
            pin.body = name;
            pin.select.is = sim::Selector::HalfSpace{{0, 0, 0}, Vec3::Unit(axis)};
            pin.only = {axis == 0, axis == 1, false};
            scene.pins.push_back(pin);
        }
    }
};

struct Course {
    Impact impact;
    double rebound = 0;  // speed afterwards over speed before
    double rise = 0;     // most of the energy over what it was before, of that at the start
    double deepest = 0;  // [domain edges]
};

/// An impact at `speed` of a ball that starts `gap` away, at 100 times.
Course thrown(const sim::Scene& scene, double speed, double gap, double duration) {
    constexpr int n = 100, apart = 3;  // times; apart that forces are told from positions
    sim::Simulation simulation(scene, frame_time);
    const double start = simulation.probes()[0].position.z(),
                 energy = tests::energy(simulation.stats()), interval = duration / n;
    std::vector<double> depth{-gap};
    Course course;
    double least = energy;
    for (int k = 1; k <= n; ++k) {
        simulation.advance_to(k * interval);
        const sim::Stats stats = simulation.stats();
        depth.push_back(start - simulation.probes()[0].position.z() - gap);
        course.rise = std::max(course.rise, (tests::energy(stats) - least) / energy);
        least = std::min(least, tests::energy(stats));
        course.deepest =
            std::max({course.deepest, stats.penetration, stats.collider_penetration});
    }
    double touch = 0, parting = 0;
    for (int k = 1; k <= n; ++k) {
        const double crossing = interval * (k - 1 + depth[k - 1] / (depth[k - 1] - depth[k]));
        if (depth[k - 1] <= 0 && depth[k] > 0)
            touch = crossing;
        if (depth[k - 1] > 0 && depth[k] <= 0)
            parting = crossing;
        course.impact.approach = std::max(course.impact.approach, depth[k]);
    }
    for (int k = apart; k + apart <= n; ++k) {
        const double second = 2 * depth[k] - depth[k - apart] - depth[k + apart];
        course.impact.force =
            std::max(course.impact.force, mass * second / std::pow(apart * interval, 2));
    }
    course.impact.duration = parting - touch;
    course.rebound = (depth[n - 10] - depth[n]) / (10 * interval) / speed;
    return course;
}

}  // namespace

TEST_CASE("the law of an impact is Hertz's where the ball is as good as a half-space") {
    // The closed solution, δ = (5mv²/4k)^0.4, F = k δ^1.5, T = 2.9433 δ/v; steps of 2e-5 s err by half of one.
    const double v = 0.3;
    const Impact impact(Law{0}, v);
    const double delta = std::pow(5 * mass * v * v / (4 * Law::stiffness()), 0.4);
    CHECK(impact.approach == Approx(delta).epsilon(1e-3));
    CHECK(impact.force == Approx(Law::stiffness() * std::pow(delta, 1.5)).epsilon(1e-3));
    CHECK(impact.duration == Approx(2.9433 * delta / v).epsilon(2e-3));
}

TEST_CASE(
    "a ball that is no half-space is stiffer than Hertz's law by its series of Legendre "
    "polynomials") {
    CHECK(correction_of_ball(0.2) == Approx(Law{}.c).epsilon(0.01));
    // As the patch shrinks, less and less of the approach.
    for (const double a : {0.05, 0.1, 0.2, 0.3}) {
        const double of_approach = correction_of_ball(a) * 4 * a / (3 * (1 - nu * nu));
        CAPTURE(a, correction_of_ball(a), of_approach);
        CHECK(of_approach > 0.25 * a);
        CHECK(of_approach < 0.6 * a);
    }
}

TEST_CASE("a ball bounces off a plane, and off another ball, by Hertz's law") {
    // Waves cross the ball three times in the meantime. 40 domains a diameter, four over the radius of the contact.
    const bool has_lower = GENERATE(false, true);
    CAPTURE(has_lower);
    const double v = 0.3, gap = 1e-4, edge = 5e-3;
    Press press(edge, gap, has_lower);
    press.scene.bodies[0].velocity = {0, 0, -v};
    if (has_lower)
        press.scene.bodies[1].velocity = {0, 0, v};
    const Course course = thrown(press.scene, v, gap, 0.054);
    const Impact corrected(Law{}, v);
    CHECK(course.impact.approach == Approx(corrected.approach).epsilon(0.05));
    CHECK(course.impact.force == Approx(corrected.force).epsilon(0.05));
    CHECK(course.impact.duration == Approx(corrected.duration).epsilon(0.05));
    if (!has_lower) {
        // Hertz's own values, B10. The plane yields as the spring of its contact, which the correction does not know.
        CHECK(course.impact.approach == Approx(4.008e-3).epsilon(0.05));
        CHECK(course.impact.force == Approx(117.6).epsilon(0.05));
        CHECK(course.impact.duration == Approx(39.3e-3).epsilon(0.05));
    }
    CHECK(course.rebound > 0.95);
    CHECK(course.rebound < 1.01);
    // Springs of a collider are not counted: a penetration of 1e-3 domains under the force of the impact.
    CHECK(course.rise < (has_lower ? 1e-6 : 1e-3));
    CHECK(course.deepest < 0.02);
}

TEST_CASE("a ball rests on a plane as deep as its weight presses it") {
    // As heavy as the force of that impact, so that the contact is as wide.
    const double weight = 117.6, edge = 5e-3;
    Press press(edge, 0, false);
    press.scene.solver.steps = sim::Steps::Implicit;
    press.scene.solver.dt = 5e-3;
    press.scene.solver.damping = 50;
    press.scene.forces = {sim::Gravity{{0, 0, -weight / mass}}};
    sim::Simulation simulation(press.scene, frame_time);
    const double start = simulation.probes()[0].position.z();
    simulation.advance_to(0.25);
    const sim::Stats stats = simulation.stats();
    const double approach = start - simulation.probes()[0].position.z();
    CHECK(approach == Approx(Law{}.approach(weight)).epsilon(0.05));
    CHECK(stats.kinetic_energy < 1e-6);
    CHECK(stats.collider_penetration < 0.01);
}

TEST_CASE("a ball that is dropped comes back nearly as high") {
    const double height = 0.01, edge = 0.01, g = 10;
    Press press(edge, height, false);
    press.scene.forces = {sim::Gravity{{0, 0, -g}}};
    sim::Simulation simulation(press.scene, frame_time);
    const double start = simulation.probes()[0].position.z();
    const double initial = tests::energy(simulation.stats());
    const double scale = mass / 4 * g * height;  // of the energy that it falls with
    double least = initial, rise = 0, highest = -1;
    for (int k = 1; k <= 60; ++k) {
        simulation.advance_to(2e-3 * k);
        const double energy = tests::energy(simulation.stats());
        rise = std::max(rise, energy - least);
        least = std::min(least, energy);
        // It touches at 45 ms for some 40 ms, and is up again at 130 ms.
        if (k > 45)
            highest = std::max(highest, simulation.probes()[0].position.z() - start + height);
        CHECK(simulation.stats().collider_penetration < 0.02);
    }
    CHECK(rise < 2e-3 * scale);
    CHECK(least > initial - 0.1 * scale);  // rebound > 0.95
    CHECK(highest > 0.8 * height);
}
