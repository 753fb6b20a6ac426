#include "sim/rigid_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace sim {

RigidMotion rigid_motion(const Field& m, const Field& x, const Field& v, int begin, int end) {
    RigidMotion rigid;
    double mass = 0;
    for (int c = begin; c < end; ++c) {
        mass += m[c][0];
        rigid.centre += m[c] * x[c];
        rigid.velocity += m[c] * v[c];
    }
    rigid.centre /= mass;
    rigid.velocity /= mass;

    // Inertia I = Σ m (r² 1 - r rᵀ) and angular momentum L about the centre; I spin = L.
    Mat3 second_moment = Mat3::Zero();
    Vec3 L = Vec3::Zero();
    for (int c = begin; c < end; ++c) {
        const Vec3 r = unpadded(x[c] - rigid.centre);
        second_moment += m[c][0] * r * r.transpose();
        L += m[c][0] * r.cross(unpadded(v[c] - rigid.velocity));
    }
    const Mat3 inertia = second_moment.trace() * Mat3::Identity() - second_moment;
    rigid.spin = padded(inertia.ldlt().solve(L));
    return rigid;
}

}  // namespace sim
