#include "shots/stages/encode.h"

#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"
#include "assets/frames/frame_cache.h"
#include "shots/stages/child_process.h"
#include "shots/stages/interruption.h"

#include <fmt/format.h>

namespace shots {
namespace {

/// Everything about the encoding but its input, rate and output.
const std::vector<std::string>& codec_options() {
    static const std::vector<std::string> options{
        // 4:2:0 needs even sides; the conversion and the tags must name the same matrix.
        "-vf",
        "pad=ceil(iw/2)*2:ceil(ih/"
        "2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
        "-colorspace",
        "bt709",
        "-color_primaries",
        "bt709",
        "-color_trc",
        "bt709",
        "-color_range",
        "tv",
        "-c:v",
        "libx264",
        "-preset",
        "medium",
        "-crf",
        "16",
        "-threads",
        "4",
        "-movflags",
        "+faststart",
        "-f",
        "mp4"};
    return options;
}

/// Text that changes whenever the film would.
std::string stamp_of(const EncodeJob& job) {
    assets::Fingerprint content{{"rate", fmt::format("{}", job.rate)},
                                {"codec", fmt::format("{}", fmt::join(codec_options(), " "))}};
    std::string pictures;
    for (const Picture& picture : job.pictures)
        pictures += picture.stamp + " ";
    content["pictures"] = pictures;
    return assets::digest(content) + "\n";
}

std::vector<std::string> command_line(const EncodeJob& job,
                                      const std::filesystem::path& output) {
    std::vector<std::string> words{"ffmpeg",
                                   "-hide_banner",
                                   "-loglevel",
                                   "error",
                                   "-y",
                                   "-f",
                                   "image2pipe",
                                   "-framerate",
                                   fmt::format("{}", job.rate),
                                   "-c:v",
                                   "png",
                                   "-i",
                                   "pipe:0"};
    words.insert(words.end(), codec_options().begin(), codec_options().end());
    words.push_back(output.string());
    return words;
}

}  // namespace

void encode(const EncodeJob& job, Progress& progress) {
    const std::filesystem::path stamp_file = job.film.string() + ".stamp";
    const std::string stamp = stamp_of(job);
    if (std::filesystem::is_regular_file(job.film)
        && std::filesystem::is_regular_file(stamp_file)
        && assets::read_whole(stamp_file) == stamp) {
        progress.say(fmt::format("encode: {} is there already", job.film.string()));
        return;
    }

    assets::UnfinishedFile film(job.film);
    ChildProcess ffmpeg(command_line(job, film.temporary()), "apt-get install ffmpeg");
    progress.start("encode", static_cast<int>(job.pictures.size()));
    for (const Picture& picture : job.pictures) {
        stop_if_interrupted();
        ffmpeg.write(assets::read_whole(picture.file));
        progress.advance(fmt::format("frame {}", picture.frame));
    }
    stop_if_interrupted();  // Ctrl-C has stopped ffmpeg too: that is no failure
    ffmpeg.finish();
    progress.finish();

    std::filesystem::remove(stamp_file);
    film.keep();
    assets::write_atomically(stamp_file, stamp);
}

}  // namespace shots
