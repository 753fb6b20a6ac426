// The directions of the studio: one convention for the camera and the lights.
#pragma once

#include "assets/base/vector_types.h"

namespace render {

/// Right-handed and orthonormal. For up = y: right = x, front = z; for up = z: right = x, front = -y.
struct StudioAxes {
    Vec3 right, up, front;  // front points from the bodies to the audience
};

/// `up` need not be of unit length; throws Error(Input, "units.up") where it is zero or not finite.
StudioAxes studio_axes(const Vec3& up);

}  // namespace render
