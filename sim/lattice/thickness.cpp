#include "sim/lattice/thickness.h"

#include <algorithm>

namespace sim {

namespace {

// Of a remembered ball's radius: how far from its middle a point belongs to the same part. The quarter more than the ball
// covers the edges of boxes roughly; what lies further is searched from.
constexpr double same_part = 1.25;

// The middle of a ball in the corner of a box is sqrt(3) radii away from the corner, which a sample may miss by a little.
constexpr double reach = 2.5;  // [radii]

}  // namespace

bool Thickness::is_thin_at(const Vec3& X, double distance) {
    if (std::any_of(balls_.begin(), balls_.end(), [&](const Ball& ball) {
            return (X - ball.middle).norm() <= same_part * ball.radius;
        }))
        return false;
    Vec3 uphill;  // gradient of the distance
    const double h = depth_ / 8;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = h * Vec3::Unit(axis);
        uphill[axis] = solid_.signed_distance(X + step) - solid_.signed_distance(X - step);
    }
    // So that rounding does not decide where sizes are whole.
    const double slightly_more = 1.02;
    if (uphill.norm() > 0
        && remember(X - (distance + slightly_more * depth_) * uphill.normalized()))
        return false;
    return !climb(X, distance);
}

bool Thickness::remember(const Vec3& middle) {
    const double radius = -solid_.signed_distance(middle);
    if (radius < depth_)
        return false;
    balls_.push_back({middle, radius});
    return true;
}

bool Thickness::climb(const Vec3& X, double distance) {
    // To the deepest of 26 neighbours while there is a deeper one, then with half the step.
    Vec3 at = X;
    double depth = -distance;
    for (double step = depth_ / 2; step > depth_ / 10;) {
        Vec3 deepest = at;
        double most = depth;
        for (int n = 0; n < 27; ++n) {
            const Vec3 to = at + step * Vec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
            if ((to - X).norm() > reach * depth_)
                continue;
            if (const double there = -solid_.signed_distance(to); there > most) {
                most = there;
                deepest = to;
            }
        }
        if (most >= depth_)
            return remember(deepest);
        if (most == depth)
            step /= 2;
        at = deepest;
        depth = most;
    }
    return false;
}

}  // namespace sim
