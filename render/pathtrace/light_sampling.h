// Choosing a point on one of the rectangle lights, and the density of that choice.
#pragma once

#include "render/pathtrace/sampler.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"

#include <optional>
#include <vector>

namespace render {

/// A point to be lit.
struct Receiver {
    Vec3f position;   // [m]
    Vec3f normal;     // unit
    bool both_sides;  // scatters light that comes from below, too
};

struct LightSample {
    Vec3f direction;  // from the lit point, unit
    float distance;
    Vec3f radiance;  // towards the lit point
    float pdf;       // [1/sr]
};

/// A point of a light as seen by the receiver; lights are chosen in proportion to about what they would bring.
/// Empty where no light shines there.
std::optional<LightSample> sample_light(const std::vector<RectangleLight>& lights,
                                        const Receiver& receiver,
                                        float choice,
                                        Pair u);

/// A light met along a ray: what it sends, and the density with which sample_light picks that point of it, once it
/// has chosen the light.
struct LightHit {
    float distance;
    Vec3f radiance;
    float pdf;  // [1/sr]
};

std::optional<LightHit> hit_light(const RectangleLight& light, const Ray& ray);

/// Probability that sample_light chooses that light.
float choice_probability(const std::vector<RectangleLight>& lights,
                         int light,
                         const Receiver& receiver);

}  // namespace render
