#include "assets/frames/checksum.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <fmt/core.h>

namespace assets {
namespace {

using Word = std::uint64_t;

// Both steps are one-to-one in `state` and in `word`, so that no single word's change is lost.
Word mix(Word state, Word word) {
    state = (state ^ word) * 0x9e3779b97f4a7c15ull;  // 2⁶⁴ / golden ratio, odd
    return state ^ (state >> 32);
}

constexpr std::size_t n_lanes = 4;  // independent, so that the multiplications overlap
using Lanes = std::array<Word, n_lanes>;

void mix_stripe(Lanes& lanes, const char* bytes) {
    Lanes words;
    std::memcpy(words.data(), bytes, sizeof words);
    for (std::size_t i = 0; i < n_lanes; ++i)
        lanes[i] = mix(lanes[i], words[i]);
}

}  // namespace

std::uint64_t checksum(std::string_view bytes) {
    Lanes lanes{1, 2, 3, 4};
    std::size_t at = 0;
    for (; at + sizeof lanes <= bytes.size(); at += sizeof lanes)
        mix_stripe(lanes, bytes.data() + at);

    // The rest is filled up with zeros; the length tells it from zeros that were there.
    std::array<char, sizeof(Lanes)> rest{};
    if (at < bytes.size())
        std::memcpy(rest.data(), bytes.data() + at, bytes.size() - at);
    mix_stripe(lanes, rest.data());

    Word result = mix(0, bytes.size());
    for (const Word lane : lanes)
        result = mix(result, lane);
    return result;
}

std::string hexadecimal(std::uint64_t value) {
    return fmt::format("{:016x}", value);
}

}  // namespace assets
