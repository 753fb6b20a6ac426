#include "shots/reading/content_hash.h"

#include "assets/base/error.h"

#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>

namespace shots {

std::string content_hash(const std::filesystem::path& file) {
    constexpr std::uint64_t offset_basis = 0xcbf29ce484222325, prime = 0x100000001b3;
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw assets::Error(assets::ErrorKind::Input,
                            fmt::format("cannot read '{}'", file.string()));

    std::uint64_t hash = offset_basis;
    std::array<char, 1 << 16> block{};
    while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
        for (std::streamsize i = 0; i < stream.gcount(); ++i)
            hash =
                (hash ^ static_cast<unsigned char>(block[static_cast<std::size_t>(i)])) * prime;
    return fmt::format("{:016x}", hash);
}

}  // namespace shots
