// The studio around the bodies: floor, lights, sky and backdrop, sized after them and the same for the whole shot.
#pragma once

#include "render/options.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"

namespace render {

/// All but the bodies. Planes among options.props become floors. Where none of them lies below, a studio floor
/// touches the lowest point if that stays in place over the shot (a body that stands) and keeps a distance otherwise
/// (a body that hangs or flies). `bounds`: one per frame, not empty.
Scene make_studio(const Options& options, const std::vector<Bounds>& bounds);

}  // namespace render
