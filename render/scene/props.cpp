#include "render/scene/props.h"

#include "assets/base/error.h"

#include <cmath>

namespace render {

namespace {

constexpr float prop_albedo = 0.42f;  // a grey that leaves the colours to the bodies
constexpr float prop_roughness = 0.45f;

void add_vertex(Mesh& mesh, const Vec3f& position, const Vec3f& normal) {
    mesh.positions.push_back(position);
    mesh.normals.push_back(normal);
    mesh.colors.push_back(Vec3f::Constant(prop_albedo));
}

// Rings of quads from pole to pole; the triangles at the poles that have no area do no harm.
Mesh sphere_mesh(const Vec3f& center, float radius) {
    constexpr int n_rings = 64, n_sides = 128;
    Mesh mesh;
    for (int i = 0; i <= n_rings; ++i)
        for (int j = 0; j <= n_sides; ++j) {
            const double theta = M_PI * i / n_rings, phi = 2 * M_PI * (j % n_sides) / n_sides;
            const Vec3 normal(std::sin(theta) * std::cos(phi),
                              std::sin(theta) * std::sin(phi),
                              std::cos(theta));
            add_vertex(mesh, center + radius * normal.cast<float>(), normal.cast<float>());
        }
    for (int i = 0; i < n_rings; ++i)
        for (int j = 0; j < n_sides; ++j) {
            const int a = i * (n_sides + 1) + j, b = a + n_sides + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

Mesh box_mesh(const Vec3f& min, const Vec3f& max) {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const int first = int(mesh.positions.size());
            const Vec3f normal = (side ? 1.0f : -1.0f) * Vec3f::Unit(axis);
            for (int k = 0; k < 4; ++k) {
                Vec3f corner = side ? max : min;
                corner[u] = k == 1 || k == 2 ? max[u] : min[u];
                corner[v] = k >= 2 ? max[v] : min[v];
                add_vertex(mesh, corner, normal);
            }
            const int second = first + (side ? 1 : 3), fourth = first + (side ? 3 : 1);
            mesh.triangles.push_back({first, second, first + 2});
            mesh.triangles.push_back({first, first + 2, fourth});
        }
    return mesh;
}

}  // namespace

Mesh prop_mesh(const Prop& prop) {
    assets::check(prop.kind != Prop::Kind::Plane, "a plane is a floor, not a mesh");
    Mesh mesh = prop.kind == Prop::Kind::Sphere
                    ? sphere_mesh(prop.center.cast<float>(), float(prop.radius))
                    : box_mesh(prop.min.cast<float>(), prop.max.cast<float>());
    mesh.material.roughness = prop_roughness;
    return mesh;
}

}  // namespace render
