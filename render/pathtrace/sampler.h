// Well-spread random numbers: the first two Sobol dimensions, Owen-scrambled by hashing and shuffled anew for each
// pair of dimensions. [Burley 2020, Practical hash-based Owen scrambling, JCGT 9(4)]
#pragma once

#include <cstdint>

namespace render {

struct Pair {
    float x, y;  // each in [0, 1)
};

/// Bits mixed so that every input bit changes about half of the output bits.
std::uint32_t hash(std::uint32_t x);

/// Sample `index` of the sequence `seed`. Every aligned block of 2^m samples puts exactly one point into each
/// elementary interval of area 2^-m; different seeds give independent sequences.
Pair owen_sobol(std::uint32_t index, std::uint32_t seed);

/// The random numbers of one path.
class Sampler {
  public:
    Sampler(std::uint32_t pixel_seed, std::uint32_t index)
        : pixel_seed_(pixel_seed), index_(index) {}

    /// The path's pair number `dimension`; each decision along a path has its own.
    Pair pair(std::uint32_t dimension) const {
        return owen_sobol(index_, hash(pixel_seed_ ^ hash(dimension)));
    }

  private:
    std::uint32_t pixel_seed_, index_;
};

}  // namespace render
