// A shot as it was read: everything that the stages need, in SI units.
#pragma once

#include "assets/frames/frame_cache.h"
#include "render/options.h"
#include "shots/reading/source_map.h"
#include "shots/text/frame_range.h"
#include "sim/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace shots {

struct Shot {
    std::string name;
    FrameRange frames;  // simulated from first to last; every step-th one is rendered
    // Simulated time per frame is 1/fps; the first frame is the state at time 0.
    double fps = 24;
    sim::Scene scene;
    render::Options render;
    std::filesystem::path output;  // folder of everything that the shot leaves behind

    assets::Fingerprint resolved;       // whatever decides the simulation, defaults filled in
    std::vector<std::string> warnings;  // "file:line:column: warning: ..."
    SourceMap sources;                  // dotted key -> place in the file

    /// Simulated time of a frame, (number - first) / fps.   [s]
    double time_of(int number) const { return (number - frames.first) / fps; }
};

}  // namespace shots
