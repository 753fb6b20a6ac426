#include "render/scene/axes.h"

#include "assets/base/error.h"

#include <Eigen/Geometry>

#include <cmath>

namespace render {

StudioAxes studio_axes(const Vec3& up) {
    const double length = up.norm();
    if (!(length > 0) || !std::isfinite(length))
        throw assets::Error(assets::ErrorKind::Input,
                            "the up direction has no length: give \"x\", \"y\" or \"z\"",
                            "units.up");
    StudioAxes axes;
    axes.up = up / length;
    const Vec3 hint = std::abs(axes.up.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
    axes.right = (hint - hint.dot(axes.up) * axes.up).normalized();
    axes.front = axes.right.cross(axes.up);
    return axes;
}

}  // namespace render
