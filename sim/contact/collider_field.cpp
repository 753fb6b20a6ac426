#include "sim/contact/collider_field.h"

#include "assets/base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace sim {

namespace {

constexpr double most_voxels = 2e8;
constexpr double blurred = 0.01;  // of the surface, that may lie on parts too thin: edges do
constexpr double band = 16;       // of a level set, in voxels

/// Whether one voxel below much of the surface the distance is not that of an inside: a wall is thinner than 1.5 voxels.
/// Which side is below the triangles of a file need not tell.
bool is_blurred(const assets::Solid& solid, const assets::TriangleMesh& surface, double voxel) {
    double area = 0, thin = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        const Vec3 p = surface.positions[a],
                   twice_area = (surface.positions[b] - p).cross(surface.positions[c] - p);
        const double size = twice_area.norm();
        if (!(size > 0))
            continue;
        const Vec3 middle = (p + surface.positions[b] + surface.positions[c]) / 3,
                   step = voxel / size * twice_area;
        area += size;
        if (!(std::min(solid.signed_distance(middle - step),
                       solid.signed_distance(middle + step))
              < -voxel / 2))
            thin += size;
    }
    return !(thin <= blurred * area) || surface.triangles.empty();
}

void check_size(const assets::Solid& solid, double voxel, double reach) {
    const Vec3 n = ((solid.max - solid.min).array() + 2 * reach) / voxel + 5;
    if (!(n.prod() < most_voxels))
        throw assets::Error(
            assets::ErrorKind::Input,
            fmt::format("a collider without a formula, {:.3g} x {:.3g} x {:.3g} m, needs "
                        "voxels of {:.2g} m for its thin "
                        "parts and the domains that meet it: {:.2g}, where {:.2g} are allowed; "
                        "make it smaller or thicker, "
                        "or put it together from boxes, spheres, cylinders and capsules",
                        solid.max.x() - solid.min.x(),
                        solid.max.y() - solid.min.y(),
                        solid.max.z() - solid.min.z(),
                        voxel,
                        n.prod(),
                        most_voxels));
}

}  // namespace

ColliderField collider_field(const assets::Source& source,
                             const assets::Solid& coarse,
                             double resolution,
                             double reach) {
    const double thinnest = (coarse.max - coarse.min).minCoeff();
    for (double voxel = std::min(resolution / 4, thinnest / 2);; voxel /= 2) {
        check_size(coarse, voxel, reach);
        const auto solid = assets::make_solid(source, voxel, band * voxel + reach);
        if (!is_blurred(*solid, assets::make_surface(source, voxel).mesh, voxel))
            return {std::make_shared<const assets::DistanceField>(*solid, voxel, reach), voxel};
    }
}

}  // namespace sim
