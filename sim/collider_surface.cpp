#include "sim/collider_surface.h"

#include "sim/embedding/creases.h"

namespace sim {

namespace {

constexpr double crease_angle = 0.7;         // [rad]
constexpr int segments_of_a_shape = 96;      // along its longest extent
const Vec3f color = Vec3f::Constant(0.35f);  // linear

double spacing(const assets::Source& source, double of_meshes) {
    const auto* shape = std::get_if<assets::Shape>(&source.geometry);
    if (shape == nullptr)
        return of_meshes;
    double extent = 0;
    for (int k = 0; k < 3; ++k)
        extent = std::max(
            extent,
            assets::support(*shape, Vec3::Unit(k)) + assets::support(*shape, -Vec3::Unit(k)));
    return extent / segments_of_a_shape;
}

}  // namespace

ColliderSurface::ColliderSurface(const Collider& collider, int index, double resolution)
    : motion_(collider, resolution) {
    const assets::Source source = collider_source(collider);
    const assets::Surface surface = assets::make_surface(source, spacing(source, resolution));
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
