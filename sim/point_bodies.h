// What shots say of parts and places of bodies, where these are made of points.
#pragma once

#include "sim/base/field.h"
#include "sim/points/material_points.h"

#include <vector>

namespace sim {

/// The points of all domains that have one of these corners, in order.
std::vector<int> points_at(const Lattice& lattice, const std::vector<int>& corners);

/// What each point (#P) takes of a load that is spread over corners by their volume: a corner's part goes to the points of
/// its domains. Sums to 1.
std::vector<double> point_shares(const Lattice& lattice, const std::vector<int>& corners);

/// A point near a place, with its weight there and the way from it to the place at rest [m].
struct NearPoint {
    int point = 0;
    double weight = 0;
    Vec3 offset{0, 0, 0};
};

/// The points within a spacing of a place along each axis, weights falling off linearly; else the nearest one.
std::vector<NearPoint> near_points(const MaterialPoints& points, const Vec3& X);

/// Σ w_p (x_p + F_p (X - X_p)): exact where F is the same all over.   x: of the body's points [m]
Vec3 carried(const std::vector<NearPoint>& near, const PointState& state, const Vec3p* x);

}  // namespace sim
