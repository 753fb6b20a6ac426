// Meshes for the spheres and boxes among a shot's props.
#pragma once

#include "render/options.h"
#include "render/scene/scene.h"

namespace render {

/// Requires a sphere or a box.
Mesh prop_mesh(const Prop& prop);

}  // namespace render
