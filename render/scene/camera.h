// The camera: placed once per shot, then asked for rays.
#pragma once

#include "render/options.h"

#include <utility>
#include <vector>

namespace render {

/// Corners (min, max) of a box that holds all bodies at one frame.   [m]
using Bounds = std::pair<Vec3f, Vec3f>;

struct Ray {
    Vec3f origin, direction;  // direction: unit
};

/// A placed camera. The picture plane at distance 1 spans ±tan_half_width and ±tan_half_height.
struct View {
    Vec3f position, right, up, forward;  // orthonormal directions; the picture's right and top
    float tan_half_width, tan_half_height;
    float lens_radius = 0;     // 0: everything is sharp   [m]
    float focus_distance = 1;  // along forward   [m]
};

/// Share of the half picture that frame_bodies leaves free at the tightest side.
inline constexpr double framing_margin = 0.12;

/// Where options.camera.frame_bodies is set: a three-quarter view, slightly from above, as close as every corner
/// of `bounds` (one per frame, not empty) stays inside the picture by the margin. Otherwise as given.
/// Throws Error(Input) naming the camera's word at fault.
View place_camera(const Options& options, const std::vector<Bounds>& bounds);

/// The ray through the point (x, y) of the picture, both in [-1, 1] from the left and from the bottom, and through
/// the point `lens_x`, `lens_y` of the unit disc on the lens.
Ray camera_ray(const View& view, float x, float y, float lens_x, float lens_y);

}  // namespace render
