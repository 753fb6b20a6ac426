// Files that are whole or not there at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace assets {

/// All bytes of a file. Throws Error(Resources) naming it where it cannot be read.
std::string read_whole(const std::filesystem::path& path);

/// Writes `bytes` to `path` through a temporary file in the same folder, flush and rename. Throws
/// Error(Resources) naming the path and the system's reason.
void write_atomically(const std::filesystem::path& path, const std::string& bytes);

/// A file that another program writes, under a temporary name beside its final one; removed with this object, unless it has
/// been kept.
class UnfinishedFile {
  public:
    explicit UnfinishedFile(std::filesystem::path path);
    ~UnfinishedFile();
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;

    const std::filesystem::path& temporary() const { return temporary_; }

    /// Flushes it to disk and gives it its final name. Throws Error(Resources).
    void keep();

  private:
    std::filesystem::path path_, temporary_;
    bool is_kept_ = false;
};

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
