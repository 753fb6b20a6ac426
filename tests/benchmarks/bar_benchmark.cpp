// Milliseconds per step of the bar of the paper's figure 13: 931 domains, dt 1 ms, implicit, one thread.
// Usage: bar_benchmark [fem|enriched|domains]...      all where none is named; CSV on stdout
#include "sim/simulation.h"
#include "tests/support/bar_scene.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <ctime>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace {

constexpr int n_windows = 10;        // of which the quickest counts: the machine may be shared
constexpr double window_time = 0.3;  // simulated [s], 300 steps

struct Timing {
    double best = 1e300, mean = 0;  // [ms] of processor time per step
    double newton = 0, cg = 0;      // iterations per step
};

double processor_milliseconds() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Timing time_method(sim::Method method) {
    tests::BarOptions options;
    options.solver.method = method;
    options.solver.dt = 1e-3;
    sim::Simulation simulation(tests::bar_scene(options), 1.0 / 24);
    Timing timing;
    int steps = 0;
    for (int k = 1; k <= n_windows; ++k) {
        const double begin = processor_milliseconds();
        simulation.advance_to(k * window_time);
        const double spent = processor_milliseconds() - begin;
        const sim::Stats stats = simulation.stats();
        timing.best = std::min(timing.best, spent / stats.steps);
        timing.mean += spent;
        timing.newton += stats.newton_iterations;
        timing.cg += stats.cg_iterations;
        steps += stats.steps;
    }
    timing.mean /= steps;
    timing.newton /= steps;
    timing.cg /= steps;
    return timing;
}

}  // namespace

int main(int argc, char** argv) {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const std::vector<std::string> asked(argv + 1, argv + argc);
    fmt::print(
        "method,domains,dt_ms,best_ms_per_step,mean_ms_per_step,newton_per_step,cg_per_step\n");
    for (const auto& [name, method] : {std::pair{"enriched", sim::Method::Enriched},
                                       std::pair{"fem", sim::Method::Fem},
                                       std::pair{"domains", sim::Method::Domains}}) {
        if (!asked.empty() && std::find(asked.begin(), asked.end(), name) == asked.end())
            continue;
        const Timing t = time_method(method);
        fmt::print(
            "{},931,1,{:.4f},{:.4f},{:.2f},{:.2f}\n", name, t.best, t.mean, t.newton, t.cg);
    }
    return 0;
}
