#include "assets/frames/layout.h"

#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"

#include <fmt/core.h>

#include <functional>
#include <string_view>
#include <system_error>
#include <vector>

namespace assets {
namespace {

constexpr std::string_view frame_prefix = "frame.", frame_suffix = ".bin";

bool is_frame_name(const std::string& name) {
    if (name.size() <= frame_prefix.size() + frame_suffix.size() || !name.starts_with(frame_prefix)
        || !name.ends_with(frame_suffix))
        return false;
    const std::string number = name.substr(
        frame_prefix.size(), name.size() - frame_prefix.size() - frame_suffix.size());
    return number.find_first_not_of("-0123456789") == std::string::npos;
}

void remove_file(const std::filesystem::path& path) {
    std::error_code reason;
    std::filesystem::remove(path, reason);
    if (reason)
        throw Error(ErrorKind::Resources,
                    fmt::format("cannot remove {}: {}", path.string(), reason.message()));
}

void remove_where(const std::filesystem::path& folder,
                  const std::function<bool(const std::string&)>& condition) {
    std::vector<std::filesystem::path> found;  // first all names: removing may disturb the listing
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (condition(entry.path().filename().string()))
            found.push_back(entry.path());
    for (const auto& path : found)
        remove_file(path);
}

}  // namespace

std::string frame_name(int number) {
    return fmt::format("{}{:04}{}", frame_prefix, number, frame_suffix);
}

bool is_cache_file(const std::string& name) {
    return name == manifest_name || name == surfaces_name || name == checkpoint_name
           || is_frame_name(name);
}

void remove_leftovers(const std::filesystem::path& folder) {
    remove_where(folder, [](const std::string& name) {
        const auto meant = name_of_temporary(name);
        return meant && is_cache_file(*meant);
    });
}

void remove_cache_files(const std::filesystem::path& folder) {
    remove_file(folder / manifest_name);
    sync_folder(folder);
    remove_where(folder, is_cache_file);
}

}  // namespace assets
