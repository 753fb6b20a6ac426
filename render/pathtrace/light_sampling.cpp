#include "render/pathtrace/light_sampling.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace render {

namespace {

Vec3f area_vector(const RectangleLight& light) {  // length: area
    return 4 * light.half_u.cross(light.half_v);
}

// Roughly the irradiance from the light's centre; never quite zero in front of the light's plane, so that every
// point that sees a part of it may choose it.
float importance(const RectangleLight& light, const Receiver& receiver) {
    const Vec3f area = area_vector(light);
    const Vec3f away = receiver.position - light.center;
    const float along = area.dot(away);
    if (along <= 0)
        return 0;
    const float area_norm = area.norm();
    // Bounded near the light.
    const float distance_squared = away.squaredNorm() + area_norm / 4;
    const float distance = std::sqrt(distance_squared);
    const float facing = -receiver.normal.dot(away) / distance;
    const float cosine = std::max(receiver.both_sides ? std::abs(facing) : facing, 0.03f);
    return light.radiance.sum() * cosine * (along / distance + 1e-2f * area_norm)
           / distance_squared;
}

float solid_angle_pdf(const RectangleLight& light, const Vec3f& direction, float distance) {
    const Vec3f area = area_vector(light);
    const float projected = -area.dot(direction);  // area · cos
    return projected > 0 ? distance * distance / projected : 0.0f;
}

}  // namespace

float choice_probability(const std::vector<RectangleLight>& lights,
                         int light,
                         const Receiver& receiver) {
    float sum = 0;
    for (const RectangleLight& other : lights)
        sum += importance(other, receiver);
    return sum > 0 ? importance(lights[light], receiver) / sum : 0.0f;
}

std::optional<LightSample> sample_light(const std::vector<RectangleLight>& lights,
                                        const Receiver& receiver,
                                        float choice,
                                        Pair u) {
    float sum = 0;
    for (const RectangleLight& light : lights)
        sum += importance(light, receiver);
    if (!(sum > 0))
        return std::nullopt;
    float left = choice * sum;
    const RectangleLight* chosen = nullptr;
    float weight = 0;
    for (const RectangleLight& light : lights) {
        const float own = importance(light, receiver);
        if (own == 0)
            continue;
        chosen = &light, weight = own;
        if (left < own)
            break;
        left -= own;
    }
    const Vec3f point =
        chosen->center + (2 * u.x - 1) * chosen->half_u + (2 * u.y - 1) * chosen->half_v;
    const float distance = (point - receiver.position).norm();
    const Vec3f direction = (point - receiver.position) / distance;
    const float density = solid_angle_pdf(*chosen, direction, distance);
    if (!(density > 0))
        return std::nullopt;
    return LightSample{direction, distance, chosen->radiance, density * weight / sum};
}

std::optional<LightHit> hit_light(const RectangleLight& light, const Ray& ray) {
    const Vec3f area = area_vector(light);
    const float speed = area.dot(ray.direction);
    if (speed >= 0)
        return std::nullopt;
    const float distance = area.dot(light.center - ray.origin) / speed;
    if (distance <= 0)
        return std::nullopt;
    const Vec3f offset = ray.origin + distance * ray.direction - light.center;
    if (std::abs(offset.dot(light.half_u)) > light.half_u.squaredNorm()
        || std::abs(offset.dot(light.half_v)) > light.half_v.squaredNorm())
        return std::nullopt;
    return LightHit{distance, light.radiance, solid_angle_pdf(light, ray.direction, distance)};
}

}  // namespace render
