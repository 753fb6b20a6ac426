#include "shots/commands.h"

#include "shots/request.h"
#include "shots/results.h"
#include "shots/stages/encode.h"
#include "shots/stages/interruption.h"
#include "shots/stages/render_frames.h"
#include "shots/stages/simulate.h"
#include "sim/simulation.h"

#include <fmt/format.h>

namespace shots {
namespace {

void run_sim(const Request& request, const Shot& shot, Progress& progress) {
    SimulateJob job;
    job.scene = shot.scene;
    job.fps = shot.fps;
    job.frames = frames_until(shot, requested_frames(request, shot).back());
    job.folder = shot.output;
    job.fingerprint = shot.resolved;
    job.overwrite = request.overwrite;
    try {
        simulate(job, progress);
    } catch (const assets::Error& error) {
        // A refused cache often means a changed shot: a mistake in that explains more than the refusal.
        if (error.kind() == assets::ErrorKind::Input && error.key().empty())
            const sim::Simulation checked(job.scene, 1 / job.fps);
        throw;
    }
}

std::vector<Picture> run_render(const Request& request, const Shot& shot, Progress& progress) {
    RenderJob job;
    job.options = shot.render;
    job.name = shot.name;
    job.frames = requested_frames(request, shot);
    job.shot_frames = frames_until(shot, shot.frames.last);
    job.cache = cache_folder(shot.output);
    job.images = shot.output / "images";
    job.overwrite = request.overwrite;
    return render_frames(job, progress);
}

/// Throws where the cache was simulated from other words than the shot now has: its pictures would lie.
void require_same_fingerprint(const Shot& shot) {
    const std::filesystem::path folder = cache_folder(shot.output);
    if (assets::FrameCacheReader(folder).fingerprint_digest() != assets::digest(shot.resolved))
        throw assets::Error(
            assets::ErrorKind::Input,
            fmt::format("{} was simulated from another version of the shot; simulate it again "
                        "(supple sim --overwrite), or choose another folder with --out",
                        folder.string()));
}

/// Pictures per second: every second frame plays half as often, so that time passes as it should. Throws where frames are
/// at uneven distances.
double playback_rate(const std::vector<int>& frames, double fps) {
    const int step = frames.size() > 1 ? frames[1] - frames[0] : 1;
    for (std::size_t k = 1; k < frames.size(); ++k)
        if (frames[k] - frames[k - 1] != step)
            throw assets::Error(
                assets::ErrorKind::Input,
                fmt::format(
                    "frames {} do not play at an even rate: choose every one of a range, as "
                    "in \"1-48\" or \"1-48x2\", or use supple render",
                    fmt::join(frames, ", ")));
    return fps / step;
}

}  // namespace

void sim_command(const Request& request) {
    const Shot shot = requested_shot(request);
    Progress progress(progress_style(request.quiet));
    with_places(shot, [&] { run_sim(request, shot, progress); });
    print_path("cache", cache_folder(shot.output), request.json);
    for (const char* table : {"probes.csv", "stats.csv", "pins.csv"})
        print_path("table", shot.output / table, request.json);
}

void render_command(const Request& request) {
    const Shot shot = requested_shot(request);
    Progress progress(progress_style(request.quiet));
    require_same_fingerprint(shot);
    std::vector<Picture> pictures;
    with_places(shot, [&] { pictures = run_render(request, shot, progress); });
    for (const Picture& picture : pictures)
        print_path("picture", picture.file, request.json);
}

void film_command(const Request& request) {
    const Shot shot = requested_shot(request);
    Progress progress(progress_style(request.quiet));
    EncodeJob job;
    job.rate = playback_rate(requested_frames(request, shot), shot.fps);
    with_places(shot, [&] {
        run_sim(request, shot, progress);
        job.pictures = run_render(request, shot, progress);
    });
    if (job.pictures.size() == 1) {
        progress.say("one frame makes no film: its picture is all there is");
        print_path("picture", job.pictures.front().file, request.json);
        return;
    }
    job.film = shot.output / (shot.name + ".mp4");
    encode(job, progress);
    print_path("film", job.film, request.json);
}

}  // namespace shots
