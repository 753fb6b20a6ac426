#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"
#include "assets/frames/checksum.h"
#include "assets/frames/encoding.h"
#include "assets/frames/fingerprint.h"
#include "assets/frames/frame_cache.h"
#include "assets/frames/layout.h"
#include "assets/frames/manifest.h"
#include "assets/frames/packed_file.h"

#include <algorithm>
#include <fmt/core.h>
#include <fstream>
#include <functional>
#include <iterator>
#include <system_error>

namespace assets {
namespace {

namespace fs = std::filesystem;

bool begins_with(const std::vector<int>& list, const std::vector<int>& start) {
    return start.size() <= list.size() && std::equal(start.begin(), start.end(), list.begin());
}

[[noreturn]] void refuse(const fs::path& folder, const std::string& what) {
    throw Error(
        ErrorKind::Input,
        fmt::format(
            "{} holds other frames: {}; start again with --overwrite, or use another --out",
            folder.string(),
            what));
}

/// Throws where frames of `wanted` cannot stand beside those of `found`. An empty surfaces_checksum is not known yet.
void require_same(const fs::path& folder, const Manifest& found, const Manifest& wanted) {
    if (found.digest != wanted.digest)
        refuse(folder, differences(found.fingerprint, wanted.fingerprint));
    if (!begins_with(found.frame_numbers, wanted.frame_numbers)
        && !begins_with(wanted.frame_numbers, found.frame_numbers))
        refuse(folder,
               fmt::format("frames: {}-{} -> {}-{}",
                           found.frame_numbers.front(),
                           found.frame_numbers.back(),
                           wanted.frame_numbers.front(),
                           wanted.frame_numbers.back()));
    if (!wanted.surfaces_checksum.empty()
        && found.surfaces_checksum != wanted.surfaces_checksum)
        refuse(folder,
               fmt::format(
                   "surfaces: {} -> {}", found.surfaces_checksum, wanted.surfaces_checksum));
}

int count_whole(const fs::path& folder, const std::vector<int>& frame_numbers) {
    const auto first_missing =
        std::find_if_not(frame_numbers.begin(), frame_numbers.end(), [&](int number) {
            return is_whole(folder / frame_name(number), FileKind::Frame, number);
        });
    return static_cast<int>(first_missing - frame_numbers.begin());
}

Manifest make_manifest(const Fingerprint& fingerprint, const std::vector<int>& frame_numbers) {
    check(!frame_numbers.empty(), "a cache has frames");
    const auto falling =
        std::adjacent_find(frame_numbers.begin(), frame_numbers.end(), std::greater_equal<>());
    check(falling == frame_numbers.end(), "frame numbers ascend");
    return {fingerprint, digest(fingerprint), frame_numbers, {}, {}};
}

void make_folder(const fs::path& folder) {
    std::error_code reason;
    fs::create_directories(folder, reason);
    if (reason)
        throw Error(ErrorKind::Resources,
                    fmt::format("cannot create {}: {}", folder.string(), reason.message()));
}

bool holds(const fs::path& path, const std::string& bytes) {
    std::ifstream file(path, std::ios::binary);
    return file && std::string(std::istreambuf_iterator<char>(file), {}) == bytes;
}

std::optional<std::pair<int, std::vector<std::byte>>> find_checkpoint(const fs::path& folder) {
    try {
        const PackedFile file = unpack(folder / checkpoint_name, FileKind::Checkpoint);
        const auto* first = reinterpret_cast<const std::byte*>(file.content.data());
        return {{file.header.number, {first, first + file.content.size()}}};
    } catch (const Error&) {
        return {};
    }
}

}  // namespace

CacheExtent cache_extent(const fs::path& folder,
                         const Fingerprint& fingerprint,
                         const std::vector<int>& frame_numbers) {
    const auto found = read_manifest(folder);
    if (!found)
        return {};
    require_same(folder, *found, make_manifest(fingerprint, frame_numbers));
    return {count_whole(folder, frame_numbers), find_checkpoint(folder)};
}

FrameCacheWriter::FrameCacheWriter(fs::path folder,
                                   const Fingerprint& fingerprint,
                                   const std::vector<int>& frame_numbers,
                                   const std::vector<CachedSurface>& surfaces,
                                   bool overwrite)
    : folder_(std::move(folder)), frame_numbers_(frame_numbers) {
    // Everything that can be refused comes before the first change on disk.
    const std::string surfaces_file = encode_surfaces(surfaces);
    Manifest wanted = make_manifest(fingerprint, frame_numbers);
    wanted.surfaces_checksum = hexadecimal(checksum(surfaces_file));
    for (const CachedSurface& surface : surfaces) {
        wanted.surface_names.push_back(surface.body + "/" + surface.skin);
        n_vertices_.push_back(surface.varying ? VertexCount{}
                                              : VertexCount{surface.rest_positions.size()});
    }
    // Whoever writes there may be about to change what the next lines read.
    if (fs::is_directory(folder_))
        lock_ = std::make_unique<FolderLock>(folder_);
    const auto found = overwrite ? std::nullopt : read_manifest(folder_);
    if (found)
        require_same(folder_, *found, wanted);

    make_folder(folder_);
    if (!lock_)
        lock_ = std::make_unique<FolderLock>(folder_);
    remove_temporaries(folder_, is_cache_file);
    if (!found)
        remove_cache_files(folder_);
    if (!holds(folder_ / surfaces_name, surfaces_file))
        write_atomically(folder_ / surfaces_name, surfaces_file);
    // A shorter list of frames leaves the longer plan on disk as it is.
    if (!found || found->frame_numbers.size() < frame_numbers_.size())
        write_manifest(folder_, wanted);
    n_whole_frames_ = count_whole(folder_, frame_numbers_);
}

void FrameCacheWriter::write(const Frame& frame) {
    const auto at = std::find(frame_numbers_.begin(), frame_numbers_.end(), frame.number);
    const auto index = static_cast<int>(at - frame_numbers_.begin());
    check(at != frame_numbers_.end() && index <= n_whole_frames_,
          "frames are written in order");
    write_atomically(folder_ / frame_name(frame.number), encode_frame(frame, n_vertices_));
    n_whole_frames_ = std::max(n_whole_frames_, index + 1);
}

void FrameCacheWriter::write_checkpoint(int frame_number, const std::vector<std::byte>& state) {
    write_atomically(folder_ / checkpoint_name, encode_checkpoint(frame_number, state));
}

}  // namespace assets
