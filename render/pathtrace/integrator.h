// The light that arrives along one camera ray: unidirectional path tracing with light sampling.
#pragma once

#include "render/pathtrace/embree_scene.h"
#include "render/pathtrace/sampler.h"

namespace render {

/// Both are weighed against each other by the power heuristic [Veach 1995]; one alone gives the same mean with more
/// noise and is there to test the other.
enum class LightSampling { Both, LightsAlone, SurfacesAlone };

struct PathOptions {
    int max_bounces = 10;
    LightSampling light_sampling = LightSampling::Both;
};

/// Radiance along a camera ray, one sample. Pair numbers 0 and 1 of the sampler belong to the camera.
Vec3f path_radiance(const EmbreeScene& rays,
                    const Scene& scene,
                    const Ray& camera_ray,
                    const Sampler& sampler,
                    const PathOptions& options);

}  // namespace render
