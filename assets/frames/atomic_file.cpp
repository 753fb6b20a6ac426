#include "assets/frames/atomic_file.h"

#include "assets/base/error.h"

#include <cerrno>
#include <fcntl.h>
#include <fmt/core.h>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace assets {
namespace {

constexpr std::string_view temporary_mark = ".tmp.";

[[noreturn]] void fail(const std::filesystem::path& path, int reason) {
    throw Error(
        ErrorKind::Resources,
        fmt::format("cannot write {}: {}; what was written before is intact, and the same "
                    "command goes on from there",
                    path.string(),
                    std::generic_category().message(reason)));
}

/// Repeats a system call that a signal cut short.
template <class Call>
auto uninterrupted(Call call) {
    auto result = call();
    while (result == -1 && errno == EINTR)
        result = call();
    return result;
}

/// A file descriptor that is closed on every way out.
class Descriptor {
  public:
    Descriptor(const std::filesystem::path& path, int flags)
        : value_(uninterrupted([&] { return ::open(path.c_str(), flags | O_CLOEXEC, 0666); })) {
    }

    ~Descriptor() { close(); }

    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    int value() const { return value_; }

    /// False where the system reports a late failure to write (network file systems).
    bool close() {
        const int closing = value_;
        value_ = -1;
        return closing < 0 || ::close(closing) == 0;
    }

  private:
    int value_ = -1;
};

/// Writes and flushes a file, anew (O_TRUNC) or at its end (O_APPEND); returns 0 or the system's reason.
int write_flushed(const std::filesystem::path& path, std::string_view bytes, int where) {
    Descriptor file(path, O_WRONLY | O_CREAT | where);
    if (file.value() < 0)
        return errno;
    while (!bytes.empty()) {
        const ssize_t n =
            uninterrupted([&] { return ::write(file.value(), bytes.data(), bytes.size()); });
        if (n <= 0)
            return n < 0 ? errno : EIO;
        bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    if (uninterrupted([&] { return ::fsync(file.value()); }) != 0)
        return errno;
    return file.close() ? 0 : errno;
}

/// "stats.csv" for ".stats.csv.tmp.4711"; empty where `name` is no temporary name of ours.
std::optional<std::string> name_of_temporary(const std::string& name) {
    const std::size_t mark = name.rfind(temporary_mark);
    if (mark == std::string::npos || mark < 2 || name.front() != '.')
        return {};
    const std::string process = name.substr(mark + temporary_mark.size());
    if (process.empty() || process.find_first_not_of("0123456789") != std::string::npos)
        return {};
    return name.substr(1, mark - 1);
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : ".";
}

std::filesystem::path temporary_of(const std::filesystem::path& path) {
    return folder_of(path)
           / fmt::format(".{}{}{}", path.filename().string(), temporary_mark, ::getpid());
}

}  // namespace

void remove_files(const std::filesystem::path& folder,
                  const std::function<bool(const std::string&)>& ours) {
    // All names first: removing may disturb the listing.
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (ours(entry.path().filename().string()))
            found.push_back(entry.path());
    for (const auto& path : found)
        if (::unlink(path.c_str()) != 0 && errno != ENOENT)
            throw Error(ErrorKind::Resources,
                        fmt::format("cannot remove {}: {}",
                                    path.string(),
                                    std::generic_category().message(errno)));
}

void remove_temporaries(const std::filesystem::path& folder,
                        const std::function<bool(const std::string&)>& ours) {
    remove_files(folder, [&](const std::string& name) {
        const auto final_name = name_of_temporary(name);
        return final_name && ours(*final_name);
    });
}

void sync_folder(const std::filesystem::path& folder) {
    const Descriptor opened(folder, O_RDONLY | O_DIRECTORY);
    if (opened.value() < 0)
        fail(folder, errno);
    // EINVAL: a file system that cannot flush folders, and so gives no more than it can.
    if (uninterrupted([&] { return ::fsync(opened.value()); }) != 0 && errno != EINVAL)
        fail(folder, errno);
}

std::string read_whole(const std::filesystem::path& path) {
    try {
        std::ifstream file(path, std::ios::binary);
        file.exceptions(std::ios::failbit | std::ios::badbit);  // as its buffer throws
        return {std::istreambuf_iterator<char>(file), {}};
    } catch (const std::ios_base::failure&) {
        throw Error(ErrorKind::Resources, fmt::format("cannot read {}", path.string()));
    }
}

void write_atomically(const std::filesystem::path& path, const std::string& bytes) {
    const std::filesystem::path temporary = temporary_of(path);
    int reason = write_flushed(temporary, bytes, O_TRUNC);
    if (reason == 0 && ::rename(temporary.c_str(), path.c_str()) != 0)
        reason = errno;
    if (reason != 0) {
        ::unlink(temporary.c_str());
        fail(path, reason);
    }
    sync_folder(folder_of(path));
}

UnfinishedFile::UnfinishedFile(std::filesystem::path path)
    : path_(std::move(path)), temporary_(temporary_of(path_)) {}

UnfinishedFile::~UnfinishedFile() {
    if (!is_kept_)
        ::unlink(temporary_.c_str());
}

void UnfinishedFile::keep() {
    Descriptor file(temporary_, O_RDONLY);
    if (file.value() < 0 || uninterrupted([&] { return ::fsync(file.value()); }) != 0
        || ::rename(temporary_.c_str(), path_.c_str()) != 0)
        fail(path_, errno);
    is_kept_ = true;
    sync_folder(folder_of(path_));
}

void append_flushed(const std::filesystem::path& path, const std::string& bytes) {
    if (const int reason = write_flushed(path, bytes, O_APPEND); reason != 0)
        fail(path, reason);
}

}  // namespace assets
