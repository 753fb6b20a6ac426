// Files that are whole or not there. write_atomically() itself is declared in frame_cache.h.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace assets {

/// "stats.csv" for ".stats.csv.tmp.4711"; empty where `name` is no temporary name of ours.
std::optional<std::string> name_of_temporary(const std::string& name);

/// Makes renamed and removed names in `folder` survive a power cut. Throws Error(Resources).
void sync_folder(const std::filesystem::path& folder);

}  // namespace assets
