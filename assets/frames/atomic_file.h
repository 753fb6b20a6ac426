// What atomic files need besides write_atomically(), which frame_cache.h declares.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace assets {

/// Removes the temporary files (".stats.csv.tmp.4711") that a killed process has left in `folder`, of those files
/// whose final name ("stats.csv") is `ours`. Throws Error(Resources).
void remove_temporaries(const std::filesystem::path& folder,
                        const std::function<bool(const std::string&)>& ours);

/// Removes the files of `folder` whose name is `ours`. Throws Error(Resources).
void remove_files(const std::filesystem::path& folder,
                  const std::function<bool(const std::string&)>& ours);

/// Makes renamed and removed names in `folder` survive a power cut. Throws Error(Resources).
void sync_folder(const std::filesystem::path& folder);

/// Appends `bytes` and flushes them to disk; not atomic: a kill may leave the first part. Throws Error(Resources).
void append_flushed(const std::filesystem::path& path, const std::string& bytes);

}  // namespace assets
