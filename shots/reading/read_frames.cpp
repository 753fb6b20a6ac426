#include "assets/base/error.h"
#include "shots/reading/readers.h"

#include <fmt/format.h>

namespace shots {

FrameRange read_frames(TableReader& root) {
    constexpr int most_frames = 1'000'000;
    FrameRange range;
    const Value* value = root.required("frames", "a range such as \"1-48\"");
    if (value == nullptr)
        return range;
    try {
        if (const auto* number = std::get_if<long long>(&value->is))
            range = parse_frame_range(std::to_string(*number));
        else if (const auto* text = std::get_if<std::string>(&value->is))
            range = parse_frame_range(*text);
        else
            root.error("frames",
                       "'frames' must be a text such as \"1-48\"; found " + kind_of(*value));
        if (range.last - range.first >= most_frames)
            root.error("frames", "'frames' are more than a million");
    } catch (const assets::Error& error) {
        root.error("frames", error.what());
    }
    // The last frame decides none before it: a longer shot goes on where the shorter one ended.
    root.record("frames.first", fmt::format("{}", range.first));
    return range;
}

}  // namespace shots
