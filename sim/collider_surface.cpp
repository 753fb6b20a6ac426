#include "sim/collider_surface.h"

#include "assets/base/error.h"
#include "sim/embedding/creases.h"

#include <algorithm>
#include <fmt/format.h>

namespace sim {

namespace {

constexpr double crease_angle = 0.7;     // [rad]
constexpr int segments_of_a_shape = 96;  // along its longest extent
constexpr double slimmest = 1.0 / 500;   // of the extents, that can be drawn at reasonable cost
const Vec3f color = Vec3f::Constant(0.35f);  // linear

/// Fine enough for a plate or a rod to have an inside, but for boxes, which are exact anyway.
double spacing(const assets::Source& source, int index, double of_meshes) {
    const auto* shape = std::get_if<assets::Shape>(&source.geometry);
    if (shape == nullptr)
        return of_meshes;
    Vec3 extent;
    for (int k = 0; k < 3; ++k)
        extent[k] =
            assets::support(*shape, Vec3::Unit(k)) + assets::support(*shape, -Vec3::Unit(k));
    const double longest = extent.maxCoeff(), thinnest = extent.minCoeff();
    if (std::holds_alternative<assets::Box>(*shape))
        return longest / segments_of_a_shape;
    if (thinnest < slimmest * longest)
        throw assets::Error(assets::ErrorKind::Input,
                            fmt::format("a collider {} m long and {} m thick is too thin to be "
                                        "drawn: make it no thinner than {} m, or use a mesh",
                                        longest,
                                        thinnest,
                                        slimmest * longest),
                            fmt::format("collider.{}", index));
    return std::min(longest / segments_of_a_shape, thinnest / 2);
}

}  // namespace

ColliderSurface::ColliderSurface(const Collider& collider, int index, double resolution)
    : motion_(collider, resolution) {
    const assets::Source source = collider_source(collider);
    const assets::Surface surface =
        assets::make_surface(source, spacing(source, index, resolution));
    CreasedMesh mesh = split_creases(surface.mesh, crease_angle);
    cached_.body = "collider";
    cached_.skin = std::to_string(index);
    cached_.triangles = std::move(mesh.triangles);
    for (const Vec3& X : mesh.positions)
        cached_.rest_positions.push_back(X.cast<float>());
    cached_.region_color.assign(mesh.positions.size(), color);
    normals_ = std::move(mesh.normals);
}

assets::SurfaceFrame ColliderSurface::at(double time) const {
    const Pose pose = motion_.pose(time);
    assets::SurfaceFrame frame;
    for (const Vec3f& X : cached_.rest_positions)
        frame.positions.push_back(pose.carry(X.cast<double>()).cast<float>());
    for (const Vec3& normal : normals_)
        frame.normals.push_back((pose.R * normal).cast<float>());
    return frame;
}

}  // namespace sim
