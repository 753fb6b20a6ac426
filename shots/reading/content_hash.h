// Tells whether a file's content has changed.
#pragma once

#include <filesystem>
#include <string>

namespace shots {

/// FNV-1a of all bytes of a file, as 16 hexadecimal digits. Throws assets::Error(Input) where it cannot be read.
std::string content_hash(const std::filesystem::path& file);

}  // namespace shots
