// Where a ray meets a surface, turned to the side it came from.
#pragma once

#include "render/pathtrace/embree_scene.h"

namespace render {

inline constexpr int no_mesh = -1;

struct SurfacePoint {
    Vec3f position;          // on the surface [m]
    Vec3f lifted;            // on the curved surface that the normals stand for [m]
    Vec3f geometric_normal;  // unit, towards the viewer
    Vec3f normal;            // for shading, unit, towards the viewer
    Vec3f color;             // albedo of the base
    float opacity = 1;
    const Coat* coat = nullptr;  // null: none on this side
    int mesh = no_mesh;          // no_mesh: a floor
    bool from_inside = false;    // the viewer is inside of the mesh
};

/// `scattered`: the ray is no more in a straight line with the camera.
SurfacePoint point_on_mesh(const EmbreeScene& rays,
                           const Mesh& mesh,
                           const MeshHit& hit,
                           const Ray& ray,
                           bool scattered);

SurfacePoint point_on_floor(const Floor& floor, const Vec3f& position);

/// Start of a ray that leaves the point to the viewer's side (or `through` to the other), clear of the surface by
/// more than the rounding error of the position.
Vec3f ray_start(const SurfacePoint& point, bool through);

}  // namespace render
