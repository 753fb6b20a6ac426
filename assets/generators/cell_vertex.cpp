#include "assets/generators/cell_vertex.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace assets {

namespace {

// Of planes of two kinds, as many of each, the second eigenvalue of the mean n nᵀ is (1 - cos) / 2 of the angle between them.
// Close to an edge that of 35 degrees counts; a whole cell may see a face from one of twenty places only.
constexpr double sharp = 0.09, suspect = 0.03;

// Least cosine between the normals of faces that meet in a cell.
constexpr double facing = -0.2;

// Bend of a cell, in its edges, up to which it holds no edge of the shape.
constexpr double flat = 0.05;

// From the surface to an edge, in cells: the edge of what is convex may pass through cells that have no vertex.
constexpr double reach = 0.75;

constexpr double slope_step = 1e-4;  // of differences, in cell edges

/// A plane n·x = level that touches the surface.
struct Plane {
    Vec3 normal{0, 0, 0};
    double level = 0;  // [m]
};

Vec3 gradient(const Shape& shape, const Vec3& x, double h) {
    Vec3 result;
    for (int i = 0; i < 3; ++i)
        result[i] = (signed_distance(shape, x + h * Vec3::Unit(i))
                     - signed_distance(shape, x - h * Vec3::Unit(i)))
                    / (2 * h);
    return result;
}

/// Seen from a place x near it: of the distance's first two terms. False where those are of no use, as on a medial axis.
bool plane_seen(const Shape& shape, const Vec3& x, double h, Plane& plane) {
    const Vec3 slope = gradient(shape, x, h);
    const double size = slope.norm();
    if (!(size > 0.1))
        return false;
    plane.normal = slope / size;
    plane.level = plane.normal.dot(x) - signed_distance(shape, x) / size;
    return true;
}

/// About where the surface crosses the segment between x and y, on different sides of it, by bisection.
Vec3 crossing(const Shape& shape, Vec3 x, Vec3 y) {
    const bool x_is_inside = signed_distance(shape, x) < 0;
    for (int k = 0; k < 6; ++k) {
        const Vec3 middle = (x + y) / 2;
        ((signed_distance(shape, middle) < 0) == x_is_inside ? x : y) = middle;
    }
    return (x + y) / 2;
}

/// Planes of the surface in a cube, and the mean direction of those where its edges cross the surface.
struct Seen {
    std::vector<Plane> planes;
    Vec3 outwards{0, 0, 0};  // unit, or zero
};

/// A cube's corners, and their distances.   [m]
struct Cube {
    std::array<Vec3, 8> corners;
    std::array<double, 8> distances{};

    Cube(const Shape& shape, const Vec3& low, double edge) {
        for (int a = 0; a < 8; ++a) {
            corners[a] = low + edge * Vec3(a & 1, a >> 1 & 1, a >> 2);
            distances[a] = signed_distance(shape, corners[a]);
        }
    }

    /// By how much distances differ from those of a plane, at most.   [m]
    double bend(const Plane& plane) const {
        double most = 0;
        for (int a = 0; a < 8; ++a)
            most = std::max(
                most, std::abs(distances[a] - plane.normal.dot(corners[a]) + plane.level));
        return most;
    }
};

/// The planes where edges of the cube cross the surface, and those that its corners see: a cube's edges may all cross one
/// face while another one ends in it. Those that face away, across a thin wall, do not count.
Seen planes_of(const Shape& shape, const Cube& cube, double edge) {
    const std::array<Vec3, 8>& corners = cube.corners;
    Seen seen;
    Plane plane;
    const double h = slope_step * edge;
    for (int a = 0; a < 8; ++a)
        for (const int side : {1, 2, 4})
            if (!(a & side) && (cube.distances[a] < 0) != (cube.distances[a | side] < 0)
                && plane_seen(
                    shape, crossing(shape, corners[a], corners[a | side]), h, plane)) {
                seen.planes.push_back(plane);
                seen.outwards += plane.normal;
            }
    if (!(seen.outwards.norm() > 0))
        return {};
    seen.outwards.normalize();
    for (const Vec3& corner : corners)
        if (plane_seen(shape, corner, h, plane) && plane.normal.dot(seen.outwards) > facing)
            seen.planes.push_back(plane);
    return seen;
}

/// The point nearest to `near` of those where Σ (n·x - level)² is least; directions in which planes hardly differ do not
/// count.
Vec3 common_point(const std::vector<Plane>& planes,
                  const Vec3& near,
                  double threshold,
                  bool& is_sharp) {
    Mat3 sum = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (const Plane& plane : planes) {
        sum += plane.normal * plane.normal.transpose();
        right += plane.normal * (plane.level - plane.normal.dot(near));
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(sum);
    Vec3 x = near;
    const double least = threshold * static_cast<double>(planes.size());
    for (int k = 0; k < 3; ++k)
        if (eigen.eigenvalues()[k] > least || k == 2)
            x += eigen.eigenvectors().col(k)
                 * (eigen.eigenvectors().col(k).dot(right) / eigen.eigenvalues()[k]);
    is_sharp = eigen.eigenvalues()[1] > least;
    return x;
}

/// Onto the edge or corner near x: from planes seen closer and closer to it.
Vec3 polished(const Shape& shape, Vec3 x, const Vec3& outwards, double edge, bool& is_sharp) {
    for (const double around : {0.2, 0.05, 0.01}) {
        std::vector<Plane> planes;
        for (int a = 0; a < 8; ++a) {
            const Vec3 diagonal(a & 1 ? 1 : -1, a & 2 ? 1 : -1, a & 4 ? 1 : -1);
            Plane plane;
            if (plane_seen(shape, x + around * edge * diagonal, slope_step * edge, plane)
                && plane.normal.dot(outwards) > facing)
                planes.push_back(plane);
        }
        if (planes.empty()) {
            is_sharp = false;
            break;
        }
        x = common_point(planes, x, sharp, is_sharp);
    }
    return x;
}

/// Newton's method on the signed distance, along its gradient.
Vec3 onto_surface(const Shape& shape, Vec3 x, double h) {
    for (int step = 0; step < 3; ++step) {
        const Vec3 slope = gradient(shape, x, h);
        if (slope.squaredNorm() > 0)
            x -= signed_distance(shape, x) / slope.squaredNorm() * slope;
    }
    return x;
}

}  // namespace

CellVertex cell_vertex(const Shape& shape, const Vec3& low, double edge, const Vec3& guess) {
    const double h = slope_step * edge;
    const Vec3 near = onto_surface(shape, guess, h);
    const Cube cube(shape, low, edge);
    Plane plane;
    if (plane_seen(shape, near, h, plane) && cube.bend(plane) < flat * edge)
        return {near, false};
    const Seen seen = planes_of(shape, cube, edge);
    bool is_sharp = false;
    const Vec3 met =
        seen.planes.empty() ? near : common_point(seen.planes, near, suspect, is_sharp);
    if (is_sharp && (met - near).norm() < reach * edge) {
        const Vec3 found = polished(shape, met, seen.outwards, edge, is_sharp);
        if (is_sharp && (found - near).norm() < reach * edge)
            return {onto_surface(shape, found, h), true};
    }
    return {near, false};
}

}  // namespace assets
