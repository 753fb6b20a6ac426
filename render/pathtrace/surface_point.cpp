#include "render/pathtrace/surface_point.h"

#include <algorithm>

namespace render {

namespace {

// The point lifted onto the tangent planes of the corners, so that the boundary of a shadow on a curved surface
// shows no facets [Hanika 2021, Hacking the shadow terminator].
Vec3f lift(const Mesh& mesh, const MeshHit& hit, const Vec3f& position, float side) {
    const auto& corners = mesh.triangles[hit.triangle];
    const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
    Vec3f lifted = position;
    for (int k = 0; k < 3; ++k) {
        const Vec3f normal = side * mesh.normals[corners[k]];
        const float below = std::min(0.0f, (position - mesh.positions[corners[k]]).dot(normal));
        lifted -= weights[k] * below * normal;
    }
    return lifted;
}

// A shading normal that the viewer cannot see is bent until it can.
Vec3f visible(const Vec3f& normal, const Vec3f& to_viewer) {
    const float cosine = normal.dot(to_viewer);
    return cosine > 1e-3f ? normal
                          : Vec3f((normal + (2e-3f - cosine) * to_viewer).normalized());
}

}  // namespace

SurfacePoint point_on_mesh(const EmbreeScene& rays,
                           const Mesh& mesh,
                           const MeshHit& hit,
                           const Ray& ray,
                           bool scattered) {
    const auto& [a, b, c] = mesh.triangles[hit.triangle];
    const float w = 1 - hit.u - hit.v;
    SurfacePoint point;
    point.from_inside = hit.geometric_normal.dot(ray.direction) > 0;
    const float side = point.from_inside ? -1.0f : 1.0f;
    point.position =
        w * mesh.positions[a] + hit.u * mesh.positions[b] + hit.v * mesh.positions[c];
    point.lifted = lift(mesh, hit, point.position, side);
    point.geometric_normal = side * hit.geometric_normal;
    point.normal =
        visible(side * shading_normal(mesh, hit.triangle, hit.u, hit.v), -ray.direction);
    point.color = w * mesh.colors[a] + hit.u * mesh.colors[b] + hit.v * mesh.colors[c];
    point.opacity = mesh.material.opacity;
    if (!point.from_inside)
        point.coat = scattered ? rays.blurred_coat(hit.mesh) : rays.coat(hit.mesh);
    point.mesh = hit.mesh;
    return point;
}

SurfacePoint point_on_floor(const Floor& floor, const Vec3f& position) {
    SurfacePoint point;
    point.position = point.lifted = position;
    point.normal = point.geometric_normal = floor.normal;
    point.color = floor.albedo;
    return point;
}

Vec3f ray_start(const SurfacePoint& point, bool through) {
    const Vec3f& position = through ? point.position : point.lifted;
    const float step = 8e-6f * (position.cwiseAbs().maxCoeff() + 1e-3f);
    return position + (through ? -step : step) * point.geometric_normal;
}

}  // namespace render
