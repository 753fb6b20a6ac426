// Bodies made of material points, as the solver hands them over, and their surfaces for the frame cache.
#pragma once

#include "assets/base/vector_types.h"
#include "assets/frames/frame_cache.h"
#include "assets/generators/point_surface.h"
#include "sim/scene.h"

#include <string>
#include <vector>

namespace sim {

/// The points of one body at one time.
struct PointCloud {
    int body = 0;                 // index in the scene
    std::string name;             // of the body
    double spacing = 0;           // cube root of the rest volume of a point [m]
    std::vector<Vec3> positions;  // (#P) [m]
    std::vector<int> region;      // (#P) index in the body
    std::vector<float> stretch;   // (#P) largest principal stretch
};

/// The surface around the points of a body, as the cache knows it: it varies, and looks as the body's first skin.
assets::CachedSurface cached_surface(const PointCloud& cloud, const Body& body);

/// That surface at a frame, given the surface around the cloud's points: colours of the regions (sRGB of the shot made
/// linear) flow into each other; attributes "stretch", a mean, and "region", the nearest point's.
assets::SurfaceFrame surface_frame(const PointCloud& cloud,
                                   const Body& body,
                                   const assets::PointSurface& surface);

}  // namespace sim
