// Locking: a cantilever of 8 × 1 × 1 with a small load at its end, in 16 × 2 × 2 cubes, with eight points and F-bar.
// Reference: an independent linear B-bar code, tip over converged tip 0.984, 0.975, 0.971, 0.973 at nu = 0.3, 0.45, 0.49,
// 0.499, where eight points without F-bar reach 0.875, 0.767, 0.616, 0.395.
#include "sim/simulation.h"
#include "tests/support/box_body.h"

#include <catch2/catch.hpp>

namespace {

constexpr double young_modulus = 1e6, load = 1e-2;  // [Pa], [N]: a tip of 2e-5 of the length

double tip(int n, double nu, sim::Quadrature quadrature) {
    sim::Scene scene;
    sim::Body bar = tests::body_of(assets::Box{{0, -0.5, -0.5}, {8, 0.5, 0.5}}, 1.0 / n);
    bar.regions[0].poisson_ratio = nu;
    bar.regions[0].young_modulus = young_modulus;
    scene.bodies = {bar};
    scene.solver.method = sim::Method::Fem;
    scene.solver.steps = sim::Steps::Static;
    scene.solver.quadrature = quadrature;
    scene.pins.push_back(
        {"wall", "body", tests::behind({0, 0, 0}, {1, 0, 0}), sim::Pin::Fixed{}});
    sim::DeadLoad end;
    end.body = "body";
    end.select = tests::behind({8, 0, 0}, {-1, 0, 0});
    end.total = Vec3(0, 0, -load);
    scene.forces.push_back(end);
    scene.probes.push_back({"tip", "body", Vec3(8, 0, 0)});
    return -sim::Simulation(scene, 1.0 / 24).probes()[0].position.z();
}

/// Timoshenko's beam, P L³/(3 E I) + P L/(k G A) with Cowper's k for squares.
double beam(double nu) {
    const double k = 10 * (1 + nu) / (12 + 11 * nu);
    return load / young_modulus * (512 * 4 + 8 * 2 * (1 + nu) / k);
}

}  // namespace

TEST_CASE("F-bar does not lock as nu nears 1/2", "[fem]") {
    struct Row {
        double nu;
        double converged;  // tip over Timoshenko's, which leaves the wall free to contract
        double reference;  // tip of the mesh over the converged one, of the reference
    };

    // Converged: 16, 32 and 64 cubes along the beam extrapolated, with this element and with one point, which agree to
    // 0.004. The wall's corner limits the order to 1, and what is called converged to about that.
    const Row row = GENERATE(Row{0.3, 0.994, 0.984},
                             Row{0.45, 0.982, 0.975},
                             Row{0.49, 0.978, 0.971},
                             Row{0.499, 0.975, 0.973});
    const double ratio =
        tip(2, row.nu, sim::Quadrature::EightPoint) / (beam(row.nu) * row.converged);
    INFO("nu " << row.nu << ": " << ratio);
    CHECK(ratio == Approx(row.reference).epsilon(0.02));
}
