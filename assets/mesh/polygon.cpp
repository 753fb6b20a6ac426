#include "assets/mesh/polygon.h"

#include <Eigen/Geometry>

#include <numeric>

namespace assets {
namespace {

using Vec2 = Eigen::Vector2d;

// Twice the area of the triangle, positive if counter-clockwise.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    const Vec2 u = b - a;
    const Vec2 v = c - a;
    return u.x() * v.y() - u.y() * v.x();
}

// The corners in the plane across their mean normal (Newell's), counter-clockwise.
std::vector<Vec2> flattened(std::span<const Vec3> corners) {
    Vec3 normal = Vec3::Zero();
    for (size_t k = 1; k + 1 < corners.size(); ++k)
        normal += (corners[k] - corners[0]).cross(corners[k + 1] - corners[0]);
    normal.stableNormalize();
    if (normal.isZero())
        normal = Vec3::UnitZ();  // a polygon without area may be cut in any plane
    const Vec3 e1 = normal.unitOrthogonal();
    const Vec3 e2 = normal.cross(e1);
    std::vector<Vec2> flat;
    flat.reserve(corners.size());
    for (const Vec3& corner : corners)
        flat.emplace_back(e1.dot(corner - corners[0]), e2.dot(corner - corners[0]));
    return flat;
}

// Whether corner k of the ring can be cut off: it turns left and no other corner lies inside the
// cut.
bool is_ear(const std::vector<Vec2>& flat, const std::vector<int>& ring, size_t k) {
    const size_t n = ring.size();
    const Vec2& a = flat[ring[(k + n - 1) % n]];
    const Vec2& b = flat[ring[k]];
    const Vec2& c = flat[ring[(k + 1) % n]];
    if (turn(a, b, c) <= 0)
        return false;
    for (size_t i = 2; i + 1 < n; ++i) {
        const Vec2& p = flat[ring[(k + i) % n]];
        const bool same_place = p == a || p == b || p == c;  // bridges to holes pass twice
        if (!same_place && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0)
            return false;
    }
    return true;
}

}  // namespace

std::vector<std::array<int, 3>> triangulate(std::span<const Vec3> corners) {
    if (corners.size() == 3)
        return {{0, 1, 2}};
    const std::vector<Vec2> flat = flattened(corners);
    std::vector<int> ring(corners.size());
    std::iota(ring.begin(), ring.end(), 0);

    std::vector<std::array<int, 3>> triangles;
    triangles.reserve(corners.size() - 2);
    for (size_t k = 1; ring.size() > 3;) {
        size_t tried = 0;
        while (tried < ring.size() && !is_ear(flat, ring, k)) {
            k = (k + 1) % ring.size();
            ++tried;
        }
        const size_t n = ring.size();
        triangles.push_back({ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(k));
        // Going on two corners further makes even triangles, where staying would make a fan.
        k = (k + 1) % ring.size();
    }
    triangles.push_back({ring[0], ring[1], ring[2]});
    return triangles;
}

}  // namespace assets
