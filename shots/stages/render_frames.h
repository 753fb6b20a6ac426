// The second stage: frames of the cache become pictures.
#pragma once

#include "render/options.h"
#include "shots/stages/progress.h"

#include <filesystem>
#include <string>
#include <vector>

namespace shots {

struct RenderJob {
    render::Options options;
    std::string name;         // of the shot: pictures are NAME.####.png
    std::vector<int> frames;  // to render, ascending
    // All of the shot: the camera frames those that the cache holds.
    std::vector<int> shot_frames;
    std::filesystem::path cache;   // folder of the frame cache
    std::filesystem::path images;  // folder of the pictures
    bool overwrite = false;        // render again what is there already
};

/// A picture on disk; `stamp` changes whenever its pixels would.
struct Picture {
    int frame = 0;
    std::filesystem::path file;
    std::string stamp;
};

/// Renders the frames whose pictures are not there yet, or come from other frames or options, and returns the pictures
/// of all of them. Throws Error(Input) where the cache lacks a frame, Error(Interrupted) between two frames after a
/// signal, and whatever cache and renderer throw.
std::vector<Picture> render_frames(const RenderJob& job, Progress& progress);

}  // namespace shots
