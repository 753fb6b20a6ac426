#include "shots/stages/simulate.h"

#include "assets/base/error.h"
#include "shots/stages/interruption.h"
#include "shots/stages/simulation_tables.h"
#include "sim/simulation.h"

#include <chrono>
#include <cstddef>
#include <fmt/core.h>

namespace shots {
namespace {

using Clock = std::chrono::steady_clock;

void check_job(const SimulateJob& job) {
    assets::check(job.fps > 0, "frames per second are positive");
    assets::check(!job.frames.empty(), "a shot has frames");
    for (std::size_t i = 0; i < job.frames.size(); ++i)
        assets::check(job.frames[i] == job.frames.front() + static_cast<int>(i),
                      "the frames to simulate are consecutive");
}

/// Whether nothing is left to do. Throws where the cache belongs to another fingerprint.
bool is_complete(const SimulateJob& job, const SimulationTables& tables) {
    const assets::CacheExtent extent =
        assets::cache_extent(cache_folder(job.folder), job.fingerprint, job.frames);
    return extent.n_whole_frames == static_cast<int>(job.frames.size())
           && extent.checkpoint_frame >= job.frames.back() && tables.reach(job.frames.back());
}

/// Restores the last checkpoint where the frames and rows up to it are whole; returns the index of the frame to
/// compute next, 0 to begin at the beginning.
int resume(const SimulateJob& job,
           const assets::FrameCacheWriter& cache,
           const SimulationTables& tables,
           sim::Simulation& simulation) {
    const auto checkpoint = cache.read_checkpoint();
    if (!checkpoint)
        return 0;
    const int index = checkpoint->first - job.frames.front();
    if (index < 0 || index >= cache.n_whole_frames() || !tables.reach(checkpoint->first))
        return 0;
    simulation.restore(checkpoint->second);
    return index + 1;
}

/// Everything about a frame reaches the disk in an order that a resume can rely on: a frame's file implies its rows,
/// a checkpoint its frame.
void compute_frame(const SimulateJob& job,
                   int index,
                   sim::Simulation& simulation,
                   const SimulationTables& tables,
                   assets::FrameCacheWriter& cache,
                   Progress& progress) {
    const int number = job.frames[static_cast<std::size_t>(index)];
    const double time = index / job.fps;
    const auto before = Clock::now();
    if (index > 0 || job.scene.solver.steps == sim::Steps::Static)
        simulation.advance_to(time);
    const double seconds = std::chrono::duration<double>(Clock::now() - before).count();
    if (const auto& failures = simulation.failures(); !failures.empty())
        progress.say(fmt::format("frame {}: {} failed steps were halved, the first: {}",
                                 number,
                                 failures.size(),
                                 failures.front()));

    tables.append(frame_rows(
        number, time, simulation.stats(), simulation.probes(), simulation.pins(), seconds));
    cache.write({number, time, simulation.deformed_surfaces()});
    cache.write_checkpoint(number, simulation.checkpoint());
}

}  // namespace

std::filesystem::path cache_folder(const std::filesystem::path& folder) {
    return folder / "cache";
}

void simulate(const SimulateJob& job, Progress& progress) {
    check_job(job);
    const SimulationTables tables(job.folder);
    const auto n_frames = static_cast<int>(job.frames.size());
    if (!job.overwrite && is_complete(job, tables)) {
        progress.say(fmt::format("sim: all {} frames are in {} already",
                                 n_frames,
                                 cache_folder(job.folder).string()));
        return;
    }

    sim::Simulation simulation(job.scene, 1 / job.fps);
    for (const std::string& note : simulation.notes())
        progress.say("note: " + note);
    assets::FrameCacheWriter cache(cache_folder(job.folder),
                                   job.fingerprint,
                                   job.frames,
                                   simulation.surfaces(),
                                   job.overwrite);
    const int first = resume(job, cache, tables, simulation);
    tables.cut_after(job.frames.front() + first - 1);

    progress.start("sim", n_frames, first);
    for (int i = first; i < n_frames; ++i) {
        stop_if_interrupted();
        compute_frame(job, i, simulation, tables, cache, progress);
        progress.advance(fmt::format("frame {}", job.frames[static_cast<std::size_t>(i)]));
    }
    progress.finish();
}

}  // namespace shots
