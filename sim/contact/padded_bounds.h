// Boxes along the axes around points of fields.
#pragma once

#include "sim/base/vectors.h"

#include <cmath>
#include <limits>

namespace sim {

/// Along the axes; empty before the first point.
struct PaddedBounds {
    Vec3p low = Vec3p{} + std::numeric_limits<double>::infinity(), high = -low;

    void add(const Vec3p& x) {
        low = smaller(low, x);
        high = larger(high, x);
    }

    bool is_empty() const { return largest_entry(low - high) > 0; }

    PaddedBounds widened(double by) const { return {low - by, high + by}; }

    bool holds(const Vec3p& x) const { return largest_entry(larger(low - x, x - high)) <= 0; }

    /// Along the axis in which they are furthest apart; below zero where they overlap in all.
    double gap(const PaddedBounds& other) const {
        return largest_entry(larger(other.low - high, low - other.high));
    }

    double distance(const PaddedBounds& other) const {
        const Vec3p apart = larger(larger(other.low - high, low - other.high), Vec3p{});
        return std::sqrt(dot(apart, apart));
    }

    void add(const PaddedBounds& other) {
        low = smaller(low, other.low);
        high = larger(high, other.high);
    }

    /// Of a point in these bounds from one in the others, at most.
    double farthest(const PaddedBounds& other) const {
        const Vec3p most = larger(high - other.low, other.high - low);
        return std::sqrt(dot(most, most));
    }
};

}  // namespace sim
