// Traditional MPM: what points keep, how they resist, when they break.
#include "sim/simulation.h"
#include "tests/support/box_body.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <vector>

using sim::Kernel;
using sim::Steps;
using sim::Transfer;

namespace {

const std::vector<Kernel> kernels = {Kernel::Linear, Kernel::Quadratic, Kernel::Cubic};
const std::vector<Transfer> transfers = {Transfer::Flip, Transfer::Apic};

sim::Scene points_scene(const sim::Body& body, Kernel kernel, Transfer transfer, Steps steps) {
    sim::Scene scene;
    scene.bodies = {body};
    scene.solver.method = sim::Method::Mpm;
    scene.solver.kernel = kernel;
    scene.solver.transfer = transfer;
    scene.solver.steps = steps;
    scene.solver.dt = 1e-3;
    return scene;
}

}  // namespace

TEST_CASE("points in free flight keep momentum and stay without stress") {
    // Through many cells at an angle to the grid; rounding of 1e-16 per step of 1e5 Pa m³ is far below 1e-9.
    const Kernel kernel = GENERATE(from_range(kernels));
    const Transfer transfer = GENERATE(from_range(transfers));
    const Steps steps = GENERATE(Steps::Explicit, Steps::Implicit);
    if (kernel == Kernel::Linear && steps == Steps::Explicit)
        return;
    CAPTURE(int(kernel), int(transfer), int(steps));
    sim::Body body = tests::box_body({4, 3, 5}, 0.05, {0.013, 0.02, -1.03});
    body.velocity = {3, -2, 1};
    sim::Simulation simulation(points_scene(body, kernel, transfer, steps), 1.0 / 24);
    const sim::Stats before = simulation.stats();
    simulation.advance_to(0.3);
    const sim::Stats after = simulation.stats();
    CAPTURE(after.newton_iterations, after.steps, after.elastic_energy, after.smallest_J);
    CHECK((after.linear_momentum - before.linear_momentum).norm()
          <= 1e-12 * before.linear_momentum.norm());
    CHECK((after.angular_momentum - before.angular_momentum).norm()
          <= 1e-9 * before.linear_momentum.norm());
    CHECK(after.total_mass == Approx(before.total_mass).epsilon(1e-13));
    CHECK(after.elastic_energy <= 1e-12 * before.kinetic_energy);
    CHECK(after.kinetic_energy == Approx(before.kinetic_energy).epsilon(1e-12));
    CHECK(std::abs(after.smallest_J - 1) <= 1e-9);
}
