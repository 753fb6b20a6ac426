#include "render/image/view_transform.h"

#include <algorithm>
#include <cmath>

namespace render {

namespace {

float shoulder(float x) {
    constexpr float room = 1 - shoulder_start;
    return x <= shoulder_start ? x : 1 - room * std::exp(-(x - shoulder_start) / room);
}

}  // namespace

float srgb_from_linear(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear
                                : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

Vec3f view_transform(const Vec3f& linear) {
    return linear.unaryExpr(
        [](float c) { return srgb_from_linear(shoulder(std::max(c, 0.0f))); });
}

}  // namespace render
