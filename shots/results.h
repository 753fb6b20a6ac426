// Results on stdout: plain lines for people, or one JSON object per line for programs.
#pragma once

#include <filesystem>
#include <string>

namespace shots {

/// The path of something that a command has made: `kind` "film", "picture", "cache", "table".
void print_path(const std::string& kind, const std::filesystem::path& path, bool json);

}  // namespace shots
