#include "assets/frames/layout.h"

#include "assets/frames/atomic_file.h"

#include <fmt/core.h>
#include <string_view>

namespace assets {
namespace {

constexpr std::string_view frame_prefix = "frame.", frame_suffix = ".bin";

bool is_frame_name(const std::string& name) {
    if (name.size() <= frame_prefix.size() + frame_suffix.size()
        || !name.starts_with(frame_prefix) || !name.ends_with(frame_suffix))
        return false;
    const std::string number = name.substr(
        frame_prefix.size(), name.size() - frame_prefix.size() - frame_suffix.size());
    return number.find_first_not_of("-0123456789") == std::string::npos;
}

}  // namespace

std::string padded(int number) {
    return number < 0 ? fmt::format("-{:04}", -number) : fmt::format("{:04}", number);
}

std::string frame_name(int number) {
    return fmt::format("{}{}{}", frame_prefix, padded(number), frame_suffix);
}

bool is_cache_file(const std::string& name) {
    return name == manifest_name || name == surfaces_name || name == checkpoint_name
           || is_frame_name(name);
}

void remove_cache_files(const std::filesystem::path& folder) {
    remove_files(folder, [](const std::string& name) { return name == manifest_name; });
    sync_folder(folder);
    remove_files(folder, is_cache_file);
}

}  // namespace assets
