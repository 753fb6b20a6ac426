// The frame cache: a folder with one file per frame, where sim and render meet.
//
//   manifest.json      version, fingerprint and its keys, frame numbers planned, surfaces (topology file, names)
//   surfaces.bin       topology and rest state of every surface, once
//   frame.NNNN.bin     positions, normals and attributes of one frame (float32); topology of surfaces that vary
//   checkpoint.bin     the simulation's state after the last whole frame (double), opaque here
//
// Every file is written under a temporary name in the same folder, flushed to disk, then renamed: a file that has
// its final name is whole. All are little-endian with magic, version, sizes and a checksum; a wrong one is refused
// with the file's name. A finished cache holds the same bytes whether or not it was interrupted: no times of day,
// durations or machine names in it.
#pragma once

#include "assets/base/vector_types.h"
#include "assets/frames/folder_lock.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace assets {

/// What does not change during a shot, per surface. Of a varying surface, which is made anew for each frame (around
/// points), only the names: it has no vertices here, and its frames bring triangles and colours.
struct CachedSurface {
    std::string body, skin;
    std::vector<std::array<int, 3>> triangles;  // (#T) counter-clockwise from outside
    std::vector<Vec3f> rest_positions;          // (#V) [m]
    std::vector<Vec3f> region_color;  // (#V) linear RGB of the region that holds the vertex
    bool varying = false;
};

/// What changes, per surface and frame.
struct SurfaceFrame {
    std::vector<Vec3f> positions;  // (#V) [m]
    std::vector<Vec3f> normals;    // (#V) unit
    // Each (#V), e.g. "stretch", "enriched".
    std::map<std::string, std::vector<float>> attributes;

    // Of varying surfaces alone, as in CachedSurface.
    std::vector<std::array<int, 3>> triangles = {};  // (#T)
    std::vector<Vec3f> region_color = {};            // (#V)
};

/// Of a surface; empty where it varies.
using VertexCount = std::optional<std::size_t>;

struct Frame {
    int number = 0;   // as in the shot's range
    double time = 0;  // [s]
    std::vector<SurfaceFrame> surfaces;
};

/// Everything that decides the frames, as sorted key -> value text (resolved shot, mesh hashes, program version).
using Fingerprint = std::map<std::string, std::string>;

/// 64-bit digest of a fingerprint as 16 hexadecimal digits.
std::string digest(const Fingerprint& fingerprint);

/// How far a cache has come.
struct CacheExtent {
    int n_whole_frames = 0;  // of those asked for, from the first, verified

    // The last one with its frame's number; empty where there is none or it is damaged. Its frame comes first, so a kill may
    // leave this one behind.
    std::optional<std::pair<int, std::vector<std::byte>>> checkpoint;
};

/// Looks into `folder` without touching anything; nothing found where it holds no cache. Throws Error(Input) where
/// FrameCacheWriter would refuse the folder.
CacheExtent cache_extent(const std::filesystem::path& folder,
                         const Fingerprint& fingerprint,
                         const std::vector<int>& frame_numbers);

class FrameCacheWriter {
  public:
    /// Opens `folder` to write, or to go on writing; `frame_numbers` ascend. Throws Error(Input) where it holds
    /// frames of another fingerprint, naming the keys that differ with old and new values, or where neither list of
    /// frames, on disk and wanted, begins with the other. Nothing is touched then. With `overwrite` whatever frames
    /// it holds are removed instead. Left-over temporary files are removed. Holds the folder while it lives: throws
    /// Error(Failed) where another process does.
    FrameCacheWriter(std::filesystem::path folder,
                     const Fingerprint& fingerprint,
                     const std::vector<int>& frame_numbers,
                     const std::vector<CachedSurface>& surfaces,
                     bool overwrite);

    /// How many of `frame_numbers`, from the first, are whole and verified on disk.
    int n_whole_frames() const { return n_whole_frames_; }

    /// Writes the next frame, or an earlier one again. Refuses (std::logic_error) values that are not finite. Throws
    /// Error(Resources) when the disk is full; the frames before stay readable.
    void write(const Frame& frame);

    /// Replaces the one checkpoint. Throws as write() does.
    void write_checkpoint(int frame_number, const std::vector<std::byte>& state);

  private:
    std::filesystem::path folder_;
    std::unique_ptr<FolderLock> lock_;
    std::vector<int> frame_numbers_;
    std::vector<VertexCount> n_vertices_;  // (#surfaces)
    int n_whole_frames_ = 0;
};

class FrameCacheReader {
  public:
    /// Throws Error(Input) where the folder is no cache, or another version's.
    explicit FrameCacheReader(std::filesystem::path folder);

    const std::vector<CachedSurface>& surfaces() const { return surfaces_; }

    const std::vector<int>& planned_frames() const { return planned_frames_; }

    const std::string& fingerprint_digest() const { return digest_; }

    /// Of surfaces(), identifies them for image stamps.
    const std::string& surfaces_checksum() const { return surfaces_checksum_; }

    /// Planned frames whose file exists (not yet verified).
    std::vector<int> frames() const;

    /// Checksum of a frame's content, from its header alone; identifies it for image stamps.
    std::uint64_t checksum(int number) const;

    /// Reads and verifies one frame. Throws Error naming the file where it is missing or damaged.
    Frame read(int number) const;

    /// Bounds of all surfaces at a frame, from its header alone: (min, max).   [m]
    std::pair<Vec3f, Vec3f> bounds(int number) const;

  private:
    std::filesystem::path folder_;
    std::vector<CachedSurface> surfaces_;
    std::vector<int> planned_frames_;
    std::string digest_, surfaces_checksum_;
};

}  // namespace assets
