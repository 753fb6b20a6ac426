#include "shots/request.h"

#include "shots/stages/progress.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace shots {

Shot requested_shot(const Request& request) {
    Shot shot = load_shot(request.shot, request.overrides);
    if (!request.out.empty())
        shot.output = request.out;
    Progress progress(progress_style(request.quiet));
    for (const std::string& warning : shot.warnings)
        progress.say(warning);
    return shot;
}

std::vector<int> requested_frames(const Request& request, const Shot& shot) {
    if (!request.frames)
        return shot.frames.numbers();
    const std::vector<int> frames = parse_frame_list(*request.frames);
    for (const int number : frames)
        if (number < shot.frames.first || number > shot.frames.last)
            throw assets::Error(
                assets::ErrorKind::Input,
                fmt::format("--frames {}: the shot has no frame {}; it has {}-{}",
                            *request.frames,
                            number,
                            shot.frames.first,
                            shot.frames.last));
    return frames;
}

std::vector<int> frames_until(const Shot& shot, int last) {
    return FrameRange{shot.frames.first, last, 1}.numbers();
}

void with_places(const Shot& shot, const std::function<void()>& work) {
    try {
        work();
    } catch (const assets::Error& error) {
        if (error.key().empty())
            throw;
        const std::string line =
            fmt::format("{}: error: {}", shot.sources.place(error.key()), error.what());
        if (error.kind() == assets::ErrorKind::Input)
            throw ShotFileError(line);
        throw assets::Error(error.kind(), line);
    }
}

}  // namespace shots
