// Boxes along the axes in single precision, eight side by side.
#pragma once

#include "sim/contact/padded_bounds.h"

#include <array>
#include <immintrin.h>
#include <limits>

namespace sim {

/// Empty as made.   [m]
struct FloatBox {
    using Vec [[gnu::vector_size(16)]] = float;  // (x, y, z, 0)

    static constexpr float infinity = std::numeric_limits<float>::infinity();

    Vec low = Vec{} + infinity, high = -low;

    FloatBox() = default;

    explicit FloatBox(const PaddedBounds& bounds)
        : low(__builtin_convertvector(bounds.low, Vec)),
          high(__builtin_convertvector(bounds.high, Vec)) {}

    void add(const FloatBox& other) {
        low = other.low < low ? other.low : low;
        high = other.high > high ? other.high : high;
    }

    bool holds(const Vec3p& x) const {
        const Vec at = __builtin_convertvector(x, Vec);
        return _mm_movemask_ps(__m128((at < low) | (at > high))) == 0;
    }

    FloatBox widened(float by) const {
        FloatBox box;
        box.low = low - by;
        box.high = high + by;
        return box;
    }
};

/// Empty as made.   [m]
class EightBoxes {
  public:
    static constexpr int n = 8;

    void set(int k, const FloatBox& box) {
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis][k] = box.low[axis];
            high_[axis][k] = box.high[axis];
        }
    }

    FloatBox box(int k) const {
        FloatBox box;
        box.low = FloatBox::Vec{low_[0][k], low_[1][k], low_[2][k], 0};
        box.high = FloatBox::Vec{high_[0][k], high_[1][k], high_[2][k], 0};
        return box;
    }

    /// That holds them all.
    FloatBox around() const {
        FloatBox all;
        for (int axis = 0; axis < 3; ++axis) {
            all.low[axis] = -largest(-low_[axis]);
            all.high[axis] = largest(high_[axis]);
        }
        return all;
    }

    /// A bit for each that meets a box.
    unsigned met_by(const FloatBox& box) const {
        return bits((low_[0] <= box.high[0]) & (high_[0] >= box.low[0])
                    & (low_[1] <= box.high[1]) & (high_[1] >= box.low[1])
                    & (low_[2] <= box.high[2]) & (high_[2] >= box.low[2]));
    }

    /// A bit for each that has points so far from points of a box, or further; those of empty boxes mean nothing.
    unsigned parted_from(const FloatBox& box, float squared_distance) const {
        const Eight x = most(0, box), y = most(1, box), z = most(2, box);
        return bits(x * x + y * y + z * z >= squared_distance);
    }

  private:
    using Eight [[gnu::vector_size(4 * n)]] = float;
    using Mask [[gnu::vector_size(4 * n)]] = int;

    static Eight larger(const Eight& a, const Eight& b) { return a > b ? a : b; }

    static float largest(Eight x) {
        x = larger(x, __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3));
        x = larger(x, __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5));
        return larger(x, __builtin_shufflevector(x, x, 1, 0, 3, 2, 5, 4, 7, 6))[0];
    }

    static unsigned bits(const Mask& mask) {
        return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(__m256i(mask))));
    }

    /// Of a point of each from one of a box, along an axis.
    Eight most(int axis, const FloatBox& box) const {
        return larger(high_[axis] - box.low[axis], box.high[axis] - low_[axis]);
    }

    static constexpr Eight empty = Eight{} + FloatBox::infinity;
    std::array<Eight, 3> low_{empty, empty, empty}, high_{-empty, -empty, -empty};
};

}  // namespace sim
