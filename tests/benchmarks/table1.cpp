// Every row of the paper's Table 1: its shot with its number of domains, grid and step, on one thread and on all; with the
// paper's contact, which is on the grid, and with contact of surfaces, which also sees where a body folds. [Z18 §6]
// The whole shot is simulated, without pictures, by implicit steps, as the paper's are, and by explicit ones. A row's time is
// that of the paper's dt in the shot, however many steps were taken for it: explicit ones are shorter where stability asks
// for it. The paper prints minutes per frame and saves every 300 steps; where a frame is 1/30 s instead, both columns shrink
// alike and the ratio stays.
#include "shots/shot_file.h"
#include "sim/simulation.h"

#include <tbb/global_control.h>
#include <tbb/info.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fmt/format.h>
#include <set>
#include <string>
#include <vector>

namespace {

constexpr double steps_per_frame = 300;

struct Row {
    const char *figure, *shot, *method;
    std::vector<std::string> overrides;
    int paper_domains = 0;
    double paper_minutes = 0;    // per frame
    std::string only_body = {};  // of a shot that compares several, empty: all
};

const std::vector<Row>& rows() {
    static const std::vector<Row> table = {
        {"8", "layered_cube", "enriched", {}, 10648, 17.811},
        {"9", "toy_ship", "enriched", {}, 9441, 14.927},
        {"10", "two_balls", "enriched", {}, 3168, 1.566},
        {"10", "two_balls", "mpm", {"solver.method=mpm"}, 3168, 0.209},
        {"11", "flower", "enriched", {}, 4904, 8.3317},
        {"11", "flower", "enriched, grid / 2", {"solver.grid_ratio=2"}, 4904, 7.2964},
        {"11", "flower", "enriched, grid / 4", {"solver.grid_ratio=4"}, 4904, 7.651},
        {"12", "dropped_ball", "enriched", {}, 4007, 6.963, "above_soft"},
        {"13", "bar", "enriched", {}, 931, 0.451},
        {"13", "bar", "mpm", {"solver.method=mpm", "solver.kernel=cubic"}, 931, 0.065},
        {"13", "bar", "fem", {"solver.method=fem"}, 931, 0.013},
        {"14", "snow_bunny", "enriched", {"solver.dt=0.1 ms"}, 27779, 36.634},
        {"15", "four_cubes", "enriched", {"solver.dt=0.1 ms"}, 27436, 73.717}};
    return table;
}

struct Timing {
    int steps = 0, cg_iterations = 0;
    double simulated = 0, processor = 0, wall = 0;  // [s]
};

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

Timing simulate(const shots::Shot& shot, std::size_t n_threads) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    Timing timing;
    const double processor = processor_seconds(), wall = wall_seconds();
    for (int frame = shot.frames.first + 1; frame <= shot.frames.last; ++frame) {
        simulation.advance_to(shot.time_of(frame));
        const sim::Stats stats = simulation.stats();
        timing.steps += stats.steps;
        timing.cg_iterations += stats.cg_iterations;
    }
    timing.simulated = shot.time_of(shot.frames.last) - shot.time_of(shot.frames.first);
    timing.processor = processor_seconds() - processor;
    timing.wall = wall_seconds() - wall;
    return timing;
}

int n_domains(const sim::Scene& scene) {
    const sim::Simulation simulation(scene, 1);
    int sum = 0;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
        sum += simulation.lattice(static_cast<int>(b)).n_domains();
    return sum;
}

/// A body by itself, for which the scene must have nothing but probes of others.
void keep_only(sim::Scene& scene, const std::string& body) {
    std::erase_if(scene.bodies, [&](const sim::Body& other) { return other.name != body; });
    std::erase_if(scene.probes, [&](const sim::Probe& probe) { return probe.body != body; });
}

shots::Shot load(const Row& row, const std::string& steps, const std::string& contact) {
    std::vector<std::string> overrides = row.overrides;
    overrides.push_back("solver.steps=" + steps);
    overrides.push_back("contact.mode=" + contact);
    shots::Shot shot =
        shots::load_shot(fmt::format("{}/shots/{}.toml", SOURCE_ROOT, row.shot), overrides);
    if (!row.only_body.empty())
        keep_only(shot.scene, row.only_body);
    return shot;
}

/// On one thread the processor's time counts, as the machine may be shared; on several the clock's.
void print_row(const Row& row,
               const std::string& steps,
               const std::string& contact,
               const shots::Shot& shot,
               std::size_t n_threads) {
    const Timing timing = simulate(shot, n_threads);
    const double dt = shot.scene.solver.dt.value(),
                 seconds = (n_threads == 1 ? timing.processor : timing.wall)
                           * (dt / timing.simulated),
                 minutes = seconds * steps_per_frame / 60;
    fmt::print("{},{},\"{}\",{},{},{},{},{},{},{},{:.1f},{:.4f},{:.3g},{:.5g},{:.0f}\n",
               row.figure,
               row.shot,
               row.method,
               steps,
               contact,
               n_domains(shot.scene),
               row.paper_domains,
               dt,
               n_threads,
               timing.steps,
               static_cast<double>(timing.cg_iterations) / timing.steps,
               1e3 * seconds,
               minutes,
               row.paper_minutes,
               row.paper_minutes / minutes);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times the rows of the paper's Table 1; CSV on stdout");
    std::vector<std::string> asked, kinds{"implicit", "explicit"}, modes{"grid", "surface"};
    std::vector<std::size_t> threads{
        1, static_cast<std::size_t>(tbb::info::default_concurrency())};
    std::set<std::string> shots;
    for (const Row& row : rows())
        shots.insert(row.shot);
    app.add_option("row", asked, "Shots whose rows are timed; all where none is named")
        ->check(CLI::IsMember(shots));
    app.add_option("--steps", kinds, "Both where none is named")
        ->allow_extra_args(false)
        ->check(CLI::IsMember({"implicit", "explicit"}));
    app.add_option("--contact", modes, "Both where none is named")
        ->allow_extra_args(false)
        ->check(CLI::IsMember({"grid", "surface"}));
    app.add_option("--threads", threads, "1 and all where none is named")
        ->allow_extra_args(false)
        ->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    fmt::print(
        "figure,shot,method,steps,contact,domains,paper_domains,dt_s,threads,n_steps,cg_per_"
        "step,ms_per_dt,"
        "minutes_per_frame,paper_minutes_per_frame,times_faster\n");
    try {
        for (const Row& row : rows()) {
            if (!asked.empty()
                && std::find(asked.begin(), asked.end(), row.shot) == asked.end())
                continue;
            for (const std::string& steps : kinds)
                for (const std::string& contact : modes) {
                    const shots::Shot shot = load(row, steps, contact);
                    for (const std::size_t n_threads : threads)
                        print_row(row, steps, contact, shot, n_threads);
                }
        }
    } catch (const std::exception& error) {
        std::fflush(stdout);
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
