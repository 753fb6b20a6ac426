#include "shots/stages/simulate.h"

#include "assets/base/error.h"
#include "assets/generators/point_surface.h"
#include "shots/stages/interruption.h"
#include "shots/stages/simulation_tables.h"
#include "shots/stages/vdb_files.h"
#include "sim/simulation.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <fmt/core.h>
#include <string>
#include <utility>

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

/// What a frame leaves beside its file in the cache.
struct Companions {
    explicit Companions(const std::filesystem::path& folder) : tables(folder), vdbs(folder) {}

    /// Whether those of all frames up to the one with this index are there. `surfaces` tell which bodies are of points.
    bool reach(const SimulateJob& job,
               int index,
               const std::vector<assets::CachedSurface>& surfaces) const {
        const std::vector<int> frames(job.frames.begin(), job.frames.begin() + index + 1);
        std::vector<std::string> of_points;
        for (const assets::CachedSurface& surface : surfaces)
            if (surface.varying)
                of_points.push_back(surface.body);
        return tables.reach(frames.back()) && vdbs.hold(of_points, frames);
    }

    void cut_after(int frame) const {
        tables.cut_after(frame);
        vdbs.cut_after(frame);
    }

    SimulationTables tables;
    VdbFiles vdbs;
};

/// What an earlier run has left to go on from: a checkpoint up to which the frames and all beside them are whole.
struct Past {
    int n_frames = 0;
    std::vector<std::byte> checkpoint;
    std::string lost = {};  // why frames that are there are of no use
};

/// Throws Error(Input) where the cache belongs to another fingerprint, or where another version of the program wrote the
/// checkpoint of a shot that is to go on: frames of two versions do not belong into one film.
Past find_past(const SimulateJob& job, const Companions& companions) {
    const std::filesystem::path folder = cache_folder(job.folder);
    assets::CacheExtent extent = assets::cache_extent(folder, job.fingerprint, job.frames);
    if (!extent.checkpoint)
        return {0, {}, extent.n_whole_frames > 0 ? "the checkpoint is lost or damaged" : ""};
    auto& [frame, checkpoint] = *extent.checkpoint;
    const int index = std::min(frame, job.frames.back()) - job.frames.front();
    if (index < 0)
        return {};
    if (index >= extent.n_whole_frames)
        return {0,
                {},
                fmt::format("frame {} is lost or damaged", job.frames[extent.n_whole_frames])};
    if (!companions.reach(job, index, assets::FrameCacheReader(folder).surfaces()))
        return {0, {}, "a table or an OpenVDB file beside the cache is lost or cut"};
    if (frame < job.frames.back() && !sim::Simulation::is_readable(checkpoint))
        throw assets::Error(
            assets::ErrorKind::Input,
            fmt::format(
                "{}: another version of supple simulated the frames up to {}; start again "
                "with --overwrite, or use another --out",
                folder.string(),
                frame));
    return {index + 1, std::move(checkpoint), {}};
}

/// Of bodies made of domains, then of colliders, then of bodies made of points.
std::vector<assets::CachedSurface> surfaces_of(const SimulateJob& job,
                                               const sim::Simulation& simulation) {
    std::vector<assets::CachedSurface> surfaces = simulation.surfaces();
    for (const sim::PointCloud& cloud : simulation.point_clouds())
        surfaces.push_back(sim::cached_surface(cloud, job.scene.bodies.at(cloud.body)));
    return surfaces;
}

/// The same surfaces now; writes those around points for other programs too.
std::vector<assets::SurfaceFrame> surfaces_at(const SimulateJob& job,
                                              int frame,
                                              const sim::Simulation& simulation,
                                              const VdbFiles& vdbs) {
    std::vector<assets::SurfaceFrame> surfaces = simulation.deformed_surfaces();
    for (const sim::PointCloud& cloud : simulation.point_clouds()) {
        const auto surface = assets::point_surface(cloud.positions, cloud.spacing);
        vdbs.write(cloud.name, frame, surface.vdb);
        surfaces.push_back(sim::surface_frame(cloud, job.scene.bodies.at(cloud.body), surface));
    }
    return surfaces;
}

/// Everything about a frame reaches the disk in an order that a resume can rely on: a frame's file implies its rows
/// and its OpenVDB files, a checkpoint its frame.
void compute_frame(const SimulateJob& job,
                   int index,
                   sim::Simulation& simulation,
                   const Companions& companions,
                   assets::FrameCacheWriter& cache,
                   Progress& progress) {
    const int number = job.frames[static_cast<std::size_t>(index)];
    const double time = index / job.fps, start = (index - 1) / job.fps;
    const auto before = Clock::now();
    if (index > 0 || job.scene.solver.steps == sim::Steps::Static)
        simulation.advance_to(time, [&](double now) {
            stop_if_interrupted();
            progress.reach((now - start) * job.fps);
        });
    const double seconds = std::chrono::duration<double>(Clock::now() - before).count();
    if (const auto& failures = simulation.failures(); !failures.empty())
        progress.say(fmt::format("frame {}: {} failed steps were halved, the first: {}",
                                 number,
                                 failures.size(),
                                 failures.front()));

    companions.tables.append(frame_rows(
        number, time, simulation.stats(), simulation.probes(), simulation.pins(), seconds));
    cache.write({number, time, surfaces_at(job, number, simulation, companions.vdbs)});
    cache.write_checkpoint(number, simulation.checkpoint());
}

}  // namespace

std::filesystem::path cache_folder(const std::filesystem::path& folder) {
    return folder / "cache";
}

void simulate(const SimulateJob& job, Progress& progress) {
    check_job(job);
    const Companions companions(job.folder);
    const auto n_frames = static_cast<int>(job.frames.size());
    const Past past = job.overwrite ? Past{} : find_past(job, companions);
    const int first = past.n_frames;
    if (!past.lost.empty())
        progress.say(fmt::format("sim: begins again at frame {}: {} in {}",
                                 job.frames.front(),
                                 past.lost,
                                 job.folder.string()));
    if (first == n_frames) {
        progress.say(fmt::format("sim: all {} frames are in {} already",
                                 n_frames,
                                 cache_folder(job.folder).string()));
        return;
    }

    sim::Simulation simulation(job.scene, 1 / job.fps);
    for (const std::string& note : simulation.notes())
        progress.say("note: " + note);
    const auto surfaces = surfaces_of(job, simulation);
    assets::FrameCacheWriter cache(
        cache_folder(job.folder), job.fingerprint, job.frames, surfaces, job.overwrite);
    if (first > 0)
        simulation.restore(past.checkpoint);
    companions.cut_after(job.frames.front() + first - 1);

    progress.start("sim", n_frames, first);
    for (int i = first; i < n_frames; ++i) {
        stop_if_interrupted();
        compute_frame(job, i, simulation, companions, cache, progress);
        progress.advance(fmt::format("frame {}", job.frames[static_cast<std::size_t>(i)]));
    }
    progress.finish();
}

}  // namespace shots
