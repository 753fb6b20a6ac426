// One writer per folder.
#pragma once

#include <filesystem>

namespace assets {

/// Holds a folder for one process (flock on the folder itself): released when it is destroyed or the process ends,
/// however it ends.
class FolderLock {
  public:
    /// Throws Error(Failed) where another process holds the folder.
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int descriptor_ = -1;
};

}  // namespace assets
