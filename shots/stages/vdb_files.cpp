#include "shots/stages/vdb_files.h"

#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"
#include "assets/frames/layout.h"

#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <system_error>

namespace shots {
namespace {

/// 17 for "snow.0017.vdb"; empty where the name is none of ours.
std::optional<int> frame_of(const std::string& name) {
    const std::size_t suffix = name.rfind(".vdb");
    if (suffix == std::string::npos || suffix + 4 != name.size() || suffix == 0)
        return {};
    const std::size_t dot = name.rfind('.', suffix - 1);
    if (dot == std::string::npos || dot == 0)
        return {};
    int frame = 0;
    const char* const end = name.data() + suffix;
    const auto [stopped, failure] = std::from_chars(name.data() + dot + 1, end, frame);
    if (failure != std::errc{} || stopped != end)
        return {};
    return frame;
}

}  // namespace

std::filesystem::path VdbFiles::path(const std::string& body, int frame) const {
    return folder_ / fmt::format("{}.{}.vdb", body, assets::padded(frame));
}

bool VdbFiles::hold(const std::vector<std::string>& bodies,
                    const std::vector<int>& frames) const {
    for (const std::string& body : bodies)
        for (const int frame : frames)
            if (!std::filesystem::exists(path(body, frame)))
                return false;
    return true;
}

void VdbFiles::cut_after(int frame) const {
    if (!std::filesystem::is_directory(folder_))
        return;
    assets::remove_temporaries(
        folder_, [](const std::string& name) { return frame_of(name).has_value(); });
    assets::remove_files(folder_,
                         [frame](const std::string& name) { return frame_of(name) > frame; });
}

void VdbFiles::write(const std::string& body, int frame, const std::string& bytes) const {
    std::error_code reason;
    std::filesystem::create_directories(folder_, reason);
    if (reason)
        throw assets::Error(
            assets::ErrorKind::Resources,
            fmt::format("cannot create {}: {}", folder_.string(), reason.message()));
    assets::write_atomically(path(body, frame), bytes);
}

}  // namespace shots
