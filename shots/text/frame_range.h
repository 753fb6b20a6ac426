// Frame numbers as production writes them: "1001-1100x2, 1200".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace shots {

/// first, first + step, ... up to last, inclusive.
struct FrameRange {
    int first = 1, last = 1, step = 1;

    std::vector<int> numbers() const;
};

/// Reads one range: "1-48", "1001-1100x2", "12", "-5-10". Throws assets::Error(Input) saying what is allowed.
FrameRange parse_frame_range(std::string_view text);

/// Reads ranges separated by commas or spaces into sorted numbers, each once. Throws as above.
std::vector<int> parse_frame_list(std::string_view text);

}  // namespace shots
