// The binary files of a cache: one fixed header, then the compressed content.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>

namespace assets {

static_assert(std::endian::native == std::endian::little, "cache files are little-endian");

enum class FileKind : std::uint32_t { Surfaces = 1, Frame = 2, Checkpoint = 3 };

/// The file's first bytes, as they are in memory. Kinds leave what they do not need at zero.
struct FileHeader {
    std::array<char, 8> magic{};
    std::uint32_t version = 0;
    FileKind kind = FileKind::Frame;
    std::int32_t number = 0;       // of the frame
    std::uint32_t word_bytes = 4;  // of the numbers inside: the compressor sorts bytes by it
    double time = 0;               // [s]
    std::array<float, 3> low{}, high{};  // bounds [m]
    std::uint64_t content_bytes = 0;     // before compression
    std::uint64_t packed_bytes = 0;      // after it: the rest of the file
    std::uint64_t checksum = 0;          // of the packed bytes
    std::uint64_t header_checksum = 0;   // of all fields above
};

static_assert(sizeof(FileHeader) == 88);

/// The whole file. `header` brings kind, number, word_bytes, time and bounds; the rest is filled in. The same bytes
/// always: one thread, fixed block sizes.
std::string pack(FileHeader header, const std::string& content);

struct PackedFile {
    FileHeader header;
    std::string content;
};

/// Throw Error naming the file: Input where it is of another version, Failed where it is missing or damaged, or is
/// not of this kind.
FileHeader read_header(const std::filesystem::path& path, FileKind kind);
PackedFile unpack(const std::filesystem::path& path, FileKind kind);

/// Whether unpack() would succeed and give this number, found without unpacking.
bool is_whole(const std::filesystem::path& path, FileKind kind, int number);

/// The error that tells of a damaged file, and what to do about it.
[[noreturn]] void report_damage(const std::filesystem::path& path, const std::string& what);

}  // namespace assets
