#include "render/scene/scene.h"

#include <algorithm>
#include <cmath>

namespace render {

namespace {

// 0 below `from`, 1 above `to`, with level ends.
float smooth_step(float from, float to, float x) {
    const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

}  // namespace

Vec3f Dome::radiance(const Vec3f& direction) const {
    const float height = up.dot(direction);
    const float t = smooth_step(0, 1, std::abs(height));
    return (1 - t) * horizon + t * (height > 0 ? zenith : nadir);
}

float Floor::presence(const Vec3f& position) const {
    return 1 - smooth_step(fade_start, fade_end, (position - point).norm());
}

std::optional<float> Floor::distance(const Vec3f& origin, const Vec3f& direction) const {
    const float height = normal.dot(origin - point), speed = normal.dot(direction);
    if (speed >= 0 || height < -1e-4f * fade_start)
        return std::nullopt;
    return std::max(0.0f, -height / speed);
}

}  // namespace render
