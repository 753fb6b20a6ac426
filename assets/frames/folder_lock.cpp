#include "assets/frames/folder_lock.h"

#include "assets/base/error.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace assets {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (descriptor_ < 0)
        throw Error(ErrorKind::Failed,
                    "cannot open " + folder.string() + ": " + std::strerror(errno));
    // File systems that know no locks (some network mounts) go without.
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        close(descriptor_);
        throw Error(ErrorKind::Failed,
                    "another process is writing " + folder.string()
                        + "; wait for it, or choose another --out");
    }
}

FolderLock::~FolderLock() {
    close(descriptor_);
}

}  // namespace assets
