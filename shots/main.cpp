// The program supple: command line, exit codes, and the one place that prints errors.
#include "assets/base/error.h"
#include "shots/commands.h"
#include "shots/shot_file.h"
#include "shots/stages/interruption.h"

#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <functional>
#include <new>
#include <optional>
#include <system_error>

namespace {

using shots::Request;

constexpr const char* examples = R"(Examples:
  supple film shots/two_balls.toml                        simulate, render, encode: out/two_balls/two_balls.mp4
  supple film shots/bar.toml --set body.bar.region.soft.young_modulus="20 kPa" --out out/softer
  supple sim shots/bar.toml --set solver.method=fem       numbers only: out/bar/probes.csv, stats.csv, pins.csv
  supple render shots/bar.toml --frames 1-48x4            pictures of some frames of the cache
  supple regions shots/two_balls.toml                     volume, mass, domains, modulus

A command that was interrupted, or starts again, goes on with what is missing.
Exit codes: 0 done; 1 failed; 2 bad usage or input; 3 diverged; 4 out of memory or disk; 75 interrupted, start again.
)";

/// Help that shows examples first.
class Help : public CLI::Formatter {
  public:
    std::string make_help(const CLI::App* app,
                          std::string name,
                          CLI::AppFormatMode mode) const override {
        const std::string help = CLI::Formatter::make_help(app, name, mode);
        return mode == CLI::AppFormatMode::Normal ? examples + help : help;
    }
};

void add_options(CLI::App& app, Request& request, int& threads) {
    app.add_option("shot", request.shot, "Shot file (TOML)")->required()->type_name("SHOT");
    app.add_option("--set", request.overrides, "Override a word of the shot file; repeatable")
        ->type_name("KEY.PATH=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    app.add_option("--frames",
                   request.frames,
                   "Frames, such as 1001-1024x2,1030; sim computes all up to the largest")
        ->type_name("RANGES");
    app.add_option("--out", request.out, "Output folder, instead of output.path")
        ->type_name("DIR");
    app.add_option("--threads", threads, "Threads; default: all cores")
        ->envname("SUPPLE_THREADS")
        ->check(CLI::Range(1, 4096));
    app.add_flag("--json", request.json, "Results as JSON lines");
    app.add_flag("--quiet", request.quiet, "No progress, no warnings");
    app.add_flag("--overwrite", request.overwrite, "Start afresh: discard what is there");
}

int fail(const std::string& message, assets::ErrorKind kind) {
    fmt::print(stderr, "{}\n", message);
    return static_cast<int>(kind);
}

/// Runs a command and turns what it throws into an exit code.
int exit_code_of(const std::function<void()>& command) {
    using assets::ErrorKind;
    try {
        shots::catch_interruptions();
        command();
        return 0;
    } catch (const shots::ShotFileError& error) {
        return fail(error.what(), error.kind());
    } catch (const assets::Error& error) {
        return fail(std::string("error: ") + error.what(), error.kind());
    } catch (const std::bad_alloc&) {
        return fail("error: out of memory; coarser domains (domain_size) need less",
                    ErrorKind::Resources);
    } catch (const std::system_error& error) {
        const bool disk_full = error.code() == std::errc::no_space_on_device;
        return fail(std::string("error: ") + error.what(),
                    disk_full ? ErrorKind::Resources : ErrorKind::Failed);
    } catch (const std::exception& error) {
        return fail(std::string("error: ") + error.what(), ErrorKind::Failed);
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("supple: shot files become films of soft bodies");
    app.formatter(std::make_shared<Help>());
    app.require_subcommand(1);

    Request request;
    int threads = 0;
    std::function<void()> command;
    const auto add = [&](const char* name, const char* about, void (*run)(const Request&)) {
        CLI::App* sub = app.add_subcommand(name, about);
        add_options(*sub, request, threads);
        sub->callback(
            [&command, &request, run] { command = [&request, run] { run(request); }; });
    };
    add("film", "Simulate, render and encode whatever is missing", shots::film_command);
    add("sim", "Simulate: frame cache and tables of numbers", shots::sim_command);
    add("render", "Render frames of the cache", shots::render_command);
    add("regions", "List bodies and regions", shots::regions_command);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : static_cast<int>(assets::ErrorKind::Input);
    }
    std::optional<tbb::global_control> limit;
    if (threads > 0)
        limit.emplace(tbb::global_control::max_allowed_parallelism,
                      static_cast<std::size_t>(threads));
    return exit_code_of(command);
}
