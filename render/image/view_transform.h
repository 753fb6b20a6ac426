// From linear light to what a screen shows, and back for colours typed by people.
#pragma once

#include "assets/base/srgb.h"

namespace render {

/// The sRGB transfer curve (IEC 61966-2-1), 0..1; its inverse is assets::linear_from_srgb().
float srgb_from_linear(float linear);
using assets::linear_from_srgb;

/// The tone curve of pictures: linear light up to `shoulder_start` as it is, so that typed colours come out as typed;
/// above it an exponential shoulder that leaves with slope 1 and nears white, so that highlights fade gently.
/// The result is sRGB-encoded, 0..1. Negative light counts as none.
Vec3f view_transform(const Vec3f& linear);

inline constexpr float shoulder_start = 0.6f;

}  // namespace render
