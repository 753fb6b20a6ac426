// What a picture is made of, as plain data in single precision. Lengths in metres, colours linear Rec.709.
#pragma once

#include "assets/base/vector_types.h"

#include <array>
#include <optional>
#include <vector>

namespace render {

/// How a surface answers light: a diffuse base under a clear glossy coat (index of refraction 1.5).
/// Below opacity 1 it is a clear gel: a skin that scatters the share `opacity` of what crosses it at right angles
/// and lets the rest go straight on, around an inside that absorbs along the way.
struct Material {
    bool coated = true;
    float roughness = 0.5f;            // of the coat, 0..1; GGX alpha is its square
    float opacity = 1.0f;              // 0..1
    Vec3f absorption = Vec3f::Zero();  // of the inside where opacity < 1   [1/m]
};

/// A surface of triangles. Normals and colours are interpolated between the vertices.
struct Mesh {
    std::vector<std::array<int, 3>> triangles;  // (#T) counter-clockwise from outside
    std::vector<Vec3f> positions;               // (#V) [m]
    std::vector<Vec3f> normals;                 // (#V) unit
    std::vector<Vec3f> colors;                  // (#V) albedo of the base, 0..1
    Material material;
};

/// A rectangle with corners center ± half_u ± half_v that shines to the side of half_u × half_v. Only reflections
/// show it: the camera looks through it, as do other lights.
struct RectangleLight {
    Vec3f center, half_u, half_v;
    Vec3f radiance;  // [W/(m² sr)], the unit of every picture
};

/// Light from all around that changes smoothly with the height above the horizon.
struct Dome {
    Vec3f up{0, 1, 0};  // unit
    Vec3f nadir, horizon, zenith;

    /// What comes from `direction` (unit, pointing away from the viewer).
    Vec3f radiance(const Vec3f& direction) const;
};

/// An endless matt floor, seen from the side of its normal alone, that fades into the backdrop with the distance
/// from `point`. It stops the paths of light, but casts no shadow: lights are above it.
struct Floor {
    Vec3f point, normal;  // normal: unit
    Vec3f albedo;
    float fade_start, fade_end;  // distances from point [m]

    /// How much of the floor is left at `position` on it: 1 near, 0 beyond fade_end.
    float presence(const Vec3f& position) const;

    /// Way from `origin` along `direction` (unit) to the floor; empty where it is never met from above. An origin
    /// that rounding has put below the floor counts as on it.   [m]
    std::optional<float> distance(const Vec3f& origin, const Vec3f& direction) const;
};

struct Scene {
    std::vector<Mesh> meshes;
    std::vector<Floor> floors;
    std::vector<RectangleLight> lights;
    Dome sky;       // lights the scene and shows in reflections
    Dome backdrop;  // seen by the camera, directly or straight through clear bodies
};

}  // namespace render
