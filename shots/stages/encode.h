// The last stage: pictures become a film, by ffmpeg.
#pragma once

#include "shots/stages/progress.h"
#include "shots/stages/render_frames.h"

#include <filesystem>
#include <vector>

namespace shots {

struct EncodeJob {
    std::vector<Picture> pictures;  // at least two, in the order of the film
    double rate = 24;               // pictures per second
    std::filesystem::path film;     // NAME.mp4
};

/// Encodes H.264 in an MP4 (4:2:0, BT.709), unless the film of these very pictures is there already; its stamp lies beside
/// it in film + ".stamp". The film appears whole or not at all. Throws Error(Failed) with ffmpeg's own words where it fails or
/// is not installed, and Error(Resources) where a picture cannot be read.
void encode(const EncodeJob& job, Progress& progress);

}  // namespace shots
