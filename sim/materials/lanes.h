// Arithmetic that reads the same for one element (double) and for several side by side (Lanes, GaussLanes).
//
// Everything here and in the laws is inlined into its caller, so that a caller compiled for several
// instruction sets, SUPPLE_LANES, gets each of them whole.
// There are no comparisons of lanes: GCC 12 splits those of 64-byte vectors into scalars on AVX2.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>

namespace sim {

inline constexpr int lane_count = 4;

/// Four doubles, one per element; +, -, *, / act on each. As many as a register of AVX2 holds: of eight, GCC keeps hardly
/// any in registers there.
using Lanes [[gnu::vector_size(8 * lane_count)]] = double;
using FloatLanes [[gnu::vector_size(4 * lane_count)]] = float;  // to store, not to compute with

/// Eight, one per Gauss point of a domain. They must stand at multiples of 64 bytes, as AVX-512 code takes for granted,
/// although their alignof is 32 where the base instruction set is AVX2: keep them in Matrix3 or in alignas(64) structs. And
/// pass them by reference to functions that are not inlined: by value, the two instruction sets differ.
using GaussLanes [[gnu::vector_size(64)]] = double;

/// The unsigned integers as wide as S.
template <class S>
struct BitsOf {
    using Type [[gnu::vector_size(sizeof(S))]] = std::uint64_t;
};

template <>
struct BitsOf<double> {
    using Type = std::uint64_t;
};

/// Four doubles that follow each other at any address, and back.
[[gnu::always_inline]] inline Lanes load_lanes(const double* from) {
    Lanes lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

[[gnu::always_inline]] inline void store_lanes(const Lanes& lanes, double* to) {
    std::memcpy(to, &lanes, sizeof lanes);
}

/// Entry j of row[i] goes to entry i of row[j], in registers.
[[gnu::always_inline]] inline void transpose(Lanes* row) {
    const Lanes a = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
    const Lanes b = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
    const Lanes c = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
    const Lanes d = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
    row[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    row[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    row[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/// A 3×3 matrix with its columns stacked: m[3j + i] = A_ij.
template <class S>
struct alignas(sizeof(S)) Matrix3 {
    S m[9];
};

/// The same number in every lane.
template <class S>
[[gnu::always_inline]] inline S uniform(double number) {
    return S{} + number;
}

/// `a` where x > 0, else `b`; one of the two where x is NaN.
template <class S>
[[gnu::always_inline]] inline S select_positive(S x, S a, S b) {
    using Bits = typename BitsOf<S>::Type;
    const Bits sign = __builtin_bit_cast(Bits, 0.0 - x) >> 63;  // 1 exactly where x > 0
    const Bits mask = 0 - sign;
    return __builtin_bit_cast(
        S, (__builtin_bit_cast(Bits, a) & mask) | (__builtin_bit_cast(Bits, b) & ~mask));
}

/// The largest entry, passing over those that are NaN.
[[gnu::always_inline]] inline double largest_lane(double x) {
    return x;
}

template <class S>
[[gnu::always_inline]] inline double largest_lane(const S& x) {
    double largest = -std::numeric_limits<double>::infinity();
    for (std::size_t lane = 0; lane < sizeof(S) / sizeof(double); ++lane)
        largest = x[lane] > largest ? x[lane] : largest;
    return largest;
}

[[gnu::always_inline]] inline double sqrt_of(double x) {
    return std::sqrt(x);
}

template <class S>
[[gnu::always_inline]] inline S sqrt_of(S x) {
    S root{};
    for (std::size_t lane = 0; lane < sizeof(S) / sizeof(double); ++lane)
        root[lane] = std::sqrt(x[lane]);
    return root;
}

/// ln x within one unit in the last place. Requires x normal and positive; elsewhere the result is
/// finite and meaningless. One formula for all machines, where std::log differs between them.
///
/// With x = 2^k m, m in [√½, √2), f = m − 1 and s = f/(2 + f):
///   ln m = 2 artanh s = 2s + sR,  R = 2s²/3 + 2s⁴/5 + …;   2s = f − sf  keeps f exact.
template <class S>
[[gnu::always_inline]] inline S log_of(S x) {
    using Bits = typename BitsOf<S>::Type;
    constexpr std::uint64_t sqrt_half = 0x3fe6a09e667f3bcd, one = 0x3ff0000000000000;
    constexpr double ln2_high = 0x1.62e42feep-1;  // k·ln2_high is exact for every exponent k
    constexpr double ln2_low = 0x1.a39ef35793c76p-33;

    const Bits bits = __builtin_bit_cast(Bits, x);
    const Bits exponent = (bits - sqrt_half + one) >> 52;  // k + 1023
    const S m = __builtin_bit_cast(S, bits - ((exponent - 1023) << 52));
    // An integer below 2^52, or'ed into the fraction of 2^52, is that much above it.
    const S k = __builtin_bit_cast(S, exponent | 0x4330000000000000) - (0x1p52 + 1023);

    const S f = m - 1.0;
    const S s = f / (2.0 + f);
    const S z = s * s;
    S R = uniform<S>(2.0 / 21);
    for (const double term :
         {2.0 / 19, 2.0 / 17, 2.0 / 15, 2.0 / 13, 2.0 / 11, 2.0 / 9, 2.0 / 7, 2.0 / 5, 2.0 / 3})
        R = R * z + term;
    R = R * z;
    const S half_square = 0.5 * f * f;
    return k * ln2_high - ((half_square - (s * (half_square + R) + k * ln2_low)) - f);
}

/// A : B = Σ A_ij B_ij.
template <class S>
[[gnu::always_inline]] inline S inner(const Matrix3<S>& A, const Matrix3<S>& B) {
    S sum = A.m[0] * B.m[0];
    for (int n = 1; n < 9; ++n)
        sum = sum + A.m[n] * B.m[n];
    return sum;
}

/// The cofactor matrix ∂J/∂F, J = det F; its columns are cross products of those of F, so it is
/// defined for singular F too.
template <class S>
[[gnu::always_inline]] inline Matrix3<S> cofactor(const Matrix3<S>& F) {
    const S* const f = F.m;
    return {{f[4] * f[8] - f[5] * f[7],
             f[5] * f[6] - f[3] * f[8],
             f[3] * f[7] - f[4] * f[6],
             f[7] * f[2] - f[8] * f[1],
             f[8] * f[0] - f[6] * f[2],
             f[6] * f[1] - f[7] * f[0],
             f[1] * f[5] - f[2] * f[4],
             f[2] * f[3] - f[0] * f[5],
             f[0] * f[4] - f[1] * f[3]}};
}

/// det F from F and its cofactor.
template <class S>
[[gnu::always_inline]] inline S determinant(const Matrix3<S>& F, const Matrix3<S>& C) {
    return F.m[0] * C.m[0] + F.m[1] * C.m[1] + F.m[2] * C.m[2];
}

template <class S>
[[gnu::always_inline]] inline S determinant(const Matrix3<S>& F) {
    return determinant(F, cofactor(F));
}

}  // namespace sim
