#include "assets/frames/packed_file.h"

#include "assets/base/error.h"
#include "assets/frames/checksum.h"

#include <algorithm>
#include <blosc.h>
#include <cstddef>
#include <cstring>
#include <fmt/core.h>
#include <fstream>
#include <string_view>
#include <system_error>

namespace assets {
namespace {

constexpr std::array<char, 8> magic{'s', 'u', 'p', 'p', 'l', 'e', '\r', '\n'};
constexpr std::uint32_t version = 2;

// Content is compressed piece by piece, each preceded by its packed size: Blosc takes at most 2 GiB at once.
using PieceSize = std::uint32_t;
constexpr std::size_t piece_bytes = std::size_t{16} << 20;
constexpr std::size_t block_bytes = std::size_t{256} << 10;  // fixed: Blosc's choice may change

void append_piece(std::string& packed, std::string_view piece, std::size_t word_bytes) {
    const std::size_t size_at = packed.size();
    const std::size_t bytes_at = size_at + sizeof(PieceSize);
    const std::size_t room = piece.size() + BLOSC_MAX_OVERHEAD;
    packed.resize(bytes_at + room);
    const int n = blosc_compress_ctx(5,
                                     BLOSC_SHUFFLE,
                                     word_bytes,
                                     piece.size(),
                                     piece.data(),
                                     packed.data() + bytes_at,
                                     room,
                                     BLOSC_LZ4_COMPNAME,
                                     block_bytes,
                                     1);
    check(n > 0, "data can be compressed");
    const auto size = static_cast<PieceSize>(n);
    std::memcpy(packed.data() + size_at, &size, sizeof size);
    packed.resize(bytes_at + size);
}

std::uint64_t header_checksum(const FileHeader& header) {
    return checksum(
        {reinterpret_cast<const char*>(&header), offsetof(FileHeader, header_checksum)});
}

FileHeader read_header(std::istream& file, const std::filesystem::path& path, FileKind kind) {
    FileHeader header;
    if (!file.read(reinterpret_cast<char*>(&header), sizeof header) || header.magic != magic)
        report_damage(path, "does not begin like a file of a frame cache");
    if (header.version != version)
        throw Error(
            ErrorKind::Input,
            fmt::format("{} has format version {}, this program reads {}; simulate again with "
                        "--overwrite",
                        path.string(),
                        header.version,
                        version));
    if (header.header_checksum != header_checksum(header) || header.kind != kind)
        report_damage(path, "has a damaged header");
    return header;
}

std::ifstream open(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw Error(
            ErrorKind::Failed,
            fmt::format("cannot read {}: it is missing; simulate again", path.string()));
    return file;
}

/// The packed bytes, verified.
std::string read_packed(std::istream& file,
                        const std::filesystem::path& path,
                        const FileHeader& header) {
    // The file's own size decides before memory is asked for.
    std::error_code unreadable;
    if (std::filesystem::file_size(path, unreadable)
        != sizeof(FileHeader) + header.packed_bytes)
        report_damage(path, "has the wrong length");
    std::string packed(header.packed_bytes, '\0');
    if (!file.read(packed.data(), static_cast<std::streamsize>(packed.size()))
        || checksum(packed) != header.checksum)
        report_damage(path, "has a wrong checksum");
    return packed;
}

}  // namespace

void report_damage(const std::filesystem::path& path, const std::string& what) {
    throw Error(
        ErrorKind::Failed,
        fmt::format("{} {}: it is damaged; remove it and simulate again", path.string(), what));
}

std::string pack(FileHeader header, const std::string& content) {
    std::string file(sizeof header, '\0');
    for (std::size_t at = 0; at < content.size(); at += piece_bytes)
        append_piece(
            file, std::string_view(content).substr(at, piece_bytes), header.word_bytes);

    header.magic = magic;
    header.version = version;
    header.content_bytes = content.size();
    header.packed_bytes = file.size() - sizeof header;
    header.checksum = checksum(std::string_view(file).substr(sizeof header));
    header.header_checksum = header_checksum(header);
    std::memcpy(file.data(), &header, sizeof header);
    return file;
}

FileHeader read_header(const std::filesystem::path& path, FileKind kind) {
    std::ifstream file = open(path);
    return read_header(file, path, kind);
}

PackedFile unpack(const std::filesystem::path& path, FileKind kind) {
    std::ifstream file = open(path);
    PackedFile result{read_header(file, path, kind), {}};
    const std::string packed = read_packed(file, path, result.header);

    result.content.resize(result.header.content_bytes);
    std::size_t from = 0;
    for (std::size_t at = 0; at < result.content.size(); at += piece_bytes) {
        PieceSize size = 0;
        std::memcpy(&size, packed.data() + from, sizeof size);
        from += sizeof size;
        const std::size_t expected = std::min(piece_bytes, result.content.size() - at);
        const int n =
            blosc_decompress_ctx(packed.data() + from, result.content.data() + at, expected, 1);
        if (n != static_cast<int>(expected))
            report_damage(path, "cannot be decompressed");
        from += size;
    }
    return result;
}

bool is_whole(const std::filesystem::path& path, FileKind kind, int number) {
    try {
        std::ifstream file = open(path);
        const FileHeader header = read_header(file, path, kind);
        read_packed(file, path, header);
        return header.number == number;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace assets
