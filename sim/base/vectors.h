// What is done with padded vectors entry by entry, and their cross product.
#pragma once

#include "sim/base/field.h"

#include <algorithm>

namespace sim {

inline Vec3p smaller(const Vec3p& a, const Vec3p& b) {
    return a < b ? a : b;
}

inline Vec3p larger(const Vec3p& a, const Vec3p& b) {
    return a > b ? a : b;
}

inline Vec3p magnitude(const Vec3p& a) {
    return larger(a, -a);
}

inline double largest_entry(const Vec3p& a) {
    return std::max({a[0], a[1], a[2]});
}

/// a × b.
inline Vec3p cross(const Vec3p& a, const Vec3p& b) {
    const auto turned = [](const Vec3p& v) {
        return __builtin_shufflevector(v, v, 1, 2, 0, 3);
    };
    return turned(a * turned(b) - turned(a) * b);
}

}  // namespace sim
