// A whole picture: paths for all pixels, in parallel.
#pragma once

#include "render/image/image.h"
#include "render/pathtrace/integrator.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"

namespace render {

struct TraceOptions {
    int width, height;       // [pixel]
    int samples;             // per pixel; powers of two spread best
    std::uint32_t seed = 0;  // another seed, another noise
    PathOptions path;
};

/// Mean radiance of each pixel under a tent filter two pixels wide. The same bytes for any number of threads.
/// Throws std::logic_error naming the first pixel with a sample that is not finite.
Image trace(const Scene& scene, const View& view, const TraceOptions& options);

}  // namespace render
