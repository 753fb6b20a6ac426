// Small meshes with known geometry for the renderer's tests.
#pragma once

#include "render/scene/scene.h"

#include <cmath>

namespace render::testing {

inline Material matt() {
    Material material;
    material.coated = false;
    return material;
}

/// A sphere cut at z <= cut · radius; cut = 1 is the whole. Seen from both sides.
inline Mesh sphere(const Vec3f& center,
                   float radius,
                   const Vec3f& albedo,
                   const Material& material,
                   float cut = 1) {
    constexpr int n_rings = 48, n_sides = 96;
    Mesh mesh;
    mesh.material = material;
    for (int i = 0; i <= n_rings; ++i)
        for (int j = 0; j < n_sides; ++j) {
            const double z = -1 + (1 + double(cut)) * (1 - std::cos(M_PI * i / n_rings)) / 2;
            const double r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * M_PI * j / n_sides;
            const Vec3f normal = Vec3(r * std::cos(phi), r * std::sin(phi), z).cast<float>();
            mesh.positions.push_back(center + radius * normal);
            mesh.normals.push_back(normal);
            mesh.colors.push_back(albedo);
        }
    for (int i = 0; i < n_rings; ++i)
        for (int j = 0; j < n_sides; ++j) {
            const int a = i * n_sides + j, b = i * n_sides + (j + 1) % n_sides;
            mesh.triangles.push_back({a, b, b + n_sides});
            mesh.triangles.push_back({a, b + n_sides, a + n_sides});
        }
    return mesh;
}

/// The square |x|, |z| <= half_size at height y, facing up.
inline Mesh ground(float y, float half_size, const Vec3f& albedo) {
    Mesh mesh;
    mesh.material = matt();
    for (const auto& [x, z] : {std::pair{-1, -1}, {-1, 1}, {1, 1}, {1, -1}})
        mesh.positions.emplace_back(half_size * float(x), y, half_size * float(z));
    mesh.normals.assign(4, Vec3f::UnitY());
    mesh.colors.assign(4, albedo);
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

inline Dome uniform_dome(float radiance) {
    return {Vec3f::UnitY(),
            Vec3f::Constant(radiance),
            Vec3f::Constant(radiance),
            Vec3f::Constant(radiance)};
}

/// A scene without lights under a sky that is the same everywhere.
inline Scene furnace(float radiance = 1) {
    Scene scene;
    scene.sky = scene.backdrop = uniform_dome(radiance);
    return scene;
}

}  // namespace render::testing
