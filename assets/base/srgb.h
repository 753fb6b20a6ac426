// Colours as people type them, made linear.
#pragma once

#include "assets/base/vector_types.h"

#include <cmath>

namespace assets {

/// The inverse of the sRGB transfer curve (IEC 61966-2-1), per channel, 0..1.
inline float linear_from_srgb(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

inline Vec3f linear_from_srgb(const Vec3f& encoded) {
    return encoded.unaryExpr([](float c) { return linear_from_srgb(c); });
}

}  // namespace assets
