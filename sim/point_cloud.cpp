#include "sim/point_cloud.h"

#include "assets/base/error.h"
#include "assets/base/srgb.h"
#include "assets/generators/point_values.h"

namespace sim {

assets::CachedSurface cached_surface(const PointCloud& cloud, const Body& body) {
    assets::CachedSurface surface;
    surface.body = cloud.name;
    surface.skin = body.skins.front().name;
    surface.varying = true;
    return surface;
}

assets::SurfaceFrame surface_frame(const PointCloud& cloud,
                                   const Body& body,
                                   const assets::PointSurface& surface) {
    const std::size_t n = cloud.positions.size();
    assets::check(cloud.region.size() == n && cloud.stretch.size() == n,
                  "a cloud tells region and stretch of each point");
    std::vector<Vec3f> colors;
    std::vector<float> regions;
    for (const int region : cloud.region) {
        colors.push_back(assets::linear_from_srgb(body.regions.at(region).color));
        regions.push_back(static_cast<float>(region));
    }
    const assets::PointValues values(cloud.positions, cloud.spacing, surface.positions);
    assets::SurfaceFrame frame{surface.positions, surface.normals, {}};
    frame.attributes["region"] = values.nearest(regions);
    frame.attributes["stretch"] = values.mean(cloud.stretch);
    frame.triangles = surface.triangles;
    frame.region_color = values.mean(colors);
    return frame;
}

}  // namespace sim
