// The rigid motion that carries a body's momentum.
#pragma once

#include "sim/base/vectors.h"

namespace sim {

/// v(x) = velocity + spin × (x - centre), and what turns an angular momentum about the centre into a spin.
/// [m], [m/s], [rad/s], [1/(kg m²)]
struct RigidMotion {
    Vec3p centre{}, velocity{}, spin{};
    Mat3 inverse_inertia = Mat3::Zero();

    Vec3p at(const Vec3p& x) const { return velocity + cross(spin, x - centre); }
};

/// The one with the linear and angular momentum of the masses m at x moving with v, over corners [begin, end). About an
/// axis from which they are no further than `thin` in the mean (radius of gyration), as points in a row are about it, it does
/// not turn: what rounding leaves of both would give any spin.   [kg], [m], [m/s], [m]
RigidMotion rigid_motion(
    const Field& m, const Field& x, const Field& v, int begin, int end, double thin);

}  // namespace sim
