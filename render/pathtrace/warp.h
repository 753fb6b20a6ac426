// From the unit square to discs, hemispheres and frames around a normal.
#pragma once

#include "assets/base/vector_types.h"
#include "render/pathtrace/sampler.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace render {

inline constexpr float pi = 3.14159265358979323846f;

/// Uniform on the unit disc; keeps the square's neighbourhoods (concentric map).
inline Pair uniform_disc(Pair u) {
    const float x = 2 * u.x - 1, y = 2 * u.y - 1;
    if (x == 0 && y == 0)
        return {0, 0};
    const bool wide = std::abs(x) > std::abs(y);
    const float radius = wide ? x : y;
    const float angle = wide ? pi / 4 * (y / x) : pi / 2 - pi / 4 * (x / y);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Direction around +z with density cos / pi.
inline Vec3f cosine_hemisphere(Pair u) {
    const Pair disc = uniform_disc(u);
    return {disc.x, disc.y, std::sqrt(std::max(0.0f, 1 - disc.x * disc.x - disc.y * disc.y))};
}

/// A right-handed orthonormal frame whose z axis is a given normal.
class LocalFrame {
  public:
    explicit LocalFrame(const Vec3f& normal) : z_(normal) {
        const float sign = std::copysign(1.0f, normal.z());
        const float a = -1 / (sign + normal.z());
        const float b = normal.x() * normal.y() * a;
        x_ = {1 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x()};
        y_ = {b, sign + normal.y() * normal.y() * a, -normal.y()};
    }

    Vec3f to_local(const Vec3f& v) const { return {x_.dot(v), y_.dot(v), z_.dot(v)}; }

    Vec3f to_world(const Vec3f& v) const { return v.x() * x_ + v.y() * y_ + v.z() * z_; }

  private:
    Vec3f x_, y_, z_;
};

}  // namespace render
