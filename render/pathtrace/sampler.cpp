#include "render/pathtrace/sampler.h"

namespace render {

namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
}

// Each bit is flipped depending on the lower bits alone: an Owen scramble of the reversed number.
std::uint32_t scramble_upwards(std::uint32_t x, std::uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

// Pascal's triangle modulo 2 times the bits of x: the second Sobol matrix, by its recursion [P P; 0 P].
std::uint32_t pascal_times(std::uint32_t x) {
    x ^= x >> 16;
    x ^= x >> 8 & 0x00ff00ffu;
    x ^= x >> 4 & 0x0f0f0f0fu;
    x ^= x >> 2 & 0x33333333u;
    return x ^ (x >> 1 & 0x55555555u);
}

float unit_float(std::uint32_t x) {
    return float(x >> 8) * 0x1p-24f;
}

}  // namespace

std::uint32_t hash(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

Pair owen_sobol(std::uint32_t index, std::uint32_t seed) {
    const std::uint32_t shuffled =
        reverse_bits(scramble_upwards(reverse_bits(index), hash(seed ^ 0x2c1b3c6du)));
    const std::uint32_t x = reverse_bits(scramble_upwards(shuffled, hash(seed ^ 0x297a2d39u)));
    const std::uint32_t y =
        reverse_bits(scramble_upwards(pascal_times(shuffled), hash(seed ^ 0x5f356495u)));
    return {unit_float(x), unit_float(y)};
}

}  // namespace render
