// How time and memory grow with the number of domains: a clamped block of n³ domains under gravity, one thread.
// Usage: scaling_benchmark [LARGEST [CASE]...]     number of domains, 100000 where it is not given; CSV on stdout
#include "sim/simulation.h"
#include "tests/support/bar_scene.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace {

struct Case {
    const char* name;
    sim::Method method;
    sim::Steps steps;
};

const Case cases[] = {{"fem explicit", sim::Method::Fem, sim::Steps::Explicit},
                      {"enriched explicit", sim::Method::Enriched, sim::Steps::Explicit},
                      {"fem implicit", sim::Method::Fem, sim::Steps::Implicit},
                      {"enriched implicit", sim::Method::Enriched, sim::Steps::Implicit},
                      {"mpm explicit", sim::Method::Mpm, sim::Steps::Explicit},  // quadratic
                      {"mpm implicit", sim::Method::Mpm, sim::Steps::Implicit}};

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double peak_gibibytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / (1 << 20);
}

/// A step of dt is a third of what s and the speed of pressure waves c allow in explicit, three times that in implicit steps;
/// several explicit ones share a map.
sim::Scene block(int n, const Case& c) {
    tests::BarOptions options;
    options.n_domains = {n, n, n};
    options.segment_ends = {n / 3, 2 * n / 3};
    options.domain_size = 0.01;
    options.solver.method = c.method;
    options.solver.steps = c.steps;
    const double wave_speed = std::sqrt(1.346 * options.end_modulus / 1000);
    options.solver.dt =
        (c.steps == sim::Steps::Explicit ? 1.0 / 3 : 3) * options.domain_size / wave_speed;
    return tests::bar_scene(options);
}

void run(int n, const Case& c) {
    const double begin = processor_seconds();
    sim::Simulation simulation(block(n, c), 1.0 / 24);
    const double ready = processor_seconds();
    // The first steps fill caches and guesses. Then as many for all, as implicit ones take more CG iterations right after the
    // start; but more where they would be over before the clock has ticked.
    const double dt = *simulation.scene().solver.dt;
    simulation.advance_to(3 * dt);
    const int n_steps = n < 20 ? 400 : 40;
    const double before = processor_seconds();
    simulation.advance_to((3 + n_steps) * dt);
    const double per_step = (processor_seconds() - before) / n_steps;
    const double n_domains = std::pow(n, 3);
    fmt::print("{},{:.0f},{:.1f},{:.3f},{:.2f},{:.1f},{:.2f}\n",
               c.name,
               n_domains,
               ready - begin,
               1e3 * per_step,
               1e-6 * n_domains / per_step,
               static_cast<double>(simulation.stats().cg_iterations) / n_steps,
               peak_gibibytes());
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const double largest = argc > 1 ? std::atof(argv[1]) : 1e5;
    const std::vector<std::string> asked(argv + std::min(argc, 2), argv + argc);
    fmt::print(
        "case,domains,setup_s,ms_per_step,million_domain_steps_per_s,cg_per_step,peak_GiB\n");
    for (const int n : {10, 22, 46, 100})
        if (std::pow(n, 3) <= 1.1 * largest)
            for (const Case& c : cases)
                if (asked.empty()
                    || std::find(asked.begin(), asked.end(), c.name) != asked.end())
                    run(n, c);
    return 0;
}
