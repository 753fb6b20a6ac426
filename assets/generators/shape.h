// Procedural shapes, and where a body's or skin's surface comes from.
#pragma once

#include "assets/base/vector_types.h"

#include <filesystem>
#include <variant>

namespace assets {

struct Box {
    Vec3 min{0, 0, 0}, max{0, 0, 0};  // [m]
};

struct Sphere {
    Vec3 center{0, 0, 0};  // [m]
    double radius = 0;     // [m]
};

struct Cylinder {  // flat ends
    Vec3 from{0, 0, 0}, to{0, 0, 0};
    double radius = 0;
};

struct Capsule {  // round ends
    Vec3 from{0, 0, 0}, to{0, 0, 0};
    double radius = 0;
};

struct Torus {
    Vec3 center{0, 0, 0}, axis{0, 0, 1};  // axis of revolution, any length > 0
    double major = 0, minor = 0;          // ring radius, tube radius [m]
};

using Shape = std::variant<Box, Sphere, Cylinder, Capsule, Torus>;

struct MeshFile {
    std::filesystem::path path;  // absolute, or relative to the working directory
};

/// x = translate + R (scale x), R = Rz Ry Rx of the angles `rotate` about the fixed axes.
struct Transform {
    double scale = 1;
    Vec3 rotate{0, 0, 0};     // [rad]
    Vec3 translate{0, 0, 0};  // [m]
};

/// A shape or a mesh file, moved.
struct Source {
    std::variant<Shape, MeshFile> geometry;
    Transform transform;
};

Vec3 apply(const Transform& transform, const Vec3& x);
Vec3 apply_inverse(const Transform& transform, const Vec3& x);

/// R of a transform.   (3×3)
Mat3 rotation(const Transform& transform);

/// Signed distance to the surface of a shape, negative inside; exact, or for the torus of the true ring.   [m]
double signed_distance(const Shape& shape, const Vec3& x);

/// Support function: max over the shape of direction·x. Bounds along any direction follow from it.   [m]
double support(const Shape& shape, const Vec3& direction);

}  // namespace assets
