// Procedural shapes, what they combine to, and where a body's or skin's surface comes from.
#pragma once

#include "assets/base/vector_types.h"

#include <filesystem>
#include <variant>
#include <vector>

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

struct Ellipsoid {
    Vec3 center{0, 0, 0}, radii{0, 0, 0};  // along x, y, z [m]
};

struct Operand;  // a shape that another one is made of

/// Constructive solid geometry.
struct Combination {
    enum class Kind { Union, Intersection, Difference } kind = Kind::Union;
    std::vector<Operand> of;  // at least one; Difference: the first without the others
    double smooth = 0;        // size of the fillet where surfaces meet [m]
};

/// The union of congruent copies of a shape: a mirrored pair, a ring of petals, or one copy elsewhere.
struct Copies {
    struct Isometry {  // from a point to where the original has it: Q x + t
        Mat3 Q = Mat3::Identity();
        Vec3 t{0, 0, 0};
    };

    std::vector<Operand> of;  // exactly one
    std::vector<Isometry> to_original;
};

using Shape =
    std::variant<Box, Sphere, Cylinder, Capsule, Torus, Ellipsoid, Combination, Copies>;

struct Operand {
    Operand(Shape of);

    Shape shape;
    Vec3 low{0, 0, 0}, high{0, 0, 0};  // bounds, wider than rounding of distances may miss [m]
};

/// A shape at translate + R x, R = rotation(rotate).
Copies moved(const Shape& shape, const Vec3& rotate, const Vec3& translate);

/// A shape and its image in the plane through `point` across `normal`.
Copies mirrored(const Shape& shape, const Vec3& point, const Vec3& normal);

/// `count` copies of a shape at equal angles about an axis, itself the first.
Copies ring_of(const Shape& shape, const Vec3& point, const Vec3& axis, int count);

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

/// Rz Ry Rx of the angles about the fixed axes, and R of a transform.   (3×3)
Mat3 rotation(const Vec3& angles);
Mat3 rotation(const Transform& transform);

/// Signed distance to the surface of a shape, negative inside; exact, or for the torus of the true ring. Of combinations
/// and copies a lower bound of its size, with the right sign and a slope of at most 1, that is exact where but one of
/// the surfaces that meet is near.   [m]
double signed_distance(const Shape& shape, const Vec3& x);

/// Signed distance, but where it is `enough` or more, anything from `enough` up to it: what a smaller distance hides need
/// not be known.   [m]
double distance_up_to(const Shape& shape, const Vec3& x, double enough);

/// Support function: max over the shape of direction·x, of combinations an upper bound. Bounds along any direction
/// follow from it. With a direction of unit length, signed_distance(x) >= direction·x - support everywhere.   [m]
double support(const Shape& shape, const Vec3& direction);

}  // namespace assets
