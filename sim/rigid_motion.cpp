#include "sim/rigid_motion.h"

#include <Eigen/Eigenvalues>

#include <array>

namespace sim {

RigidMotion rigid_motion(
    const Field& m, const Field& x, const Field& v, int begin, int end, double thin) {
    RigidMotion rigid;
    double mass = 0;
    for (int c = begin; c < end; ++c) {
        mass += m[c][0];
        rigid.centre += m[c] * x[c];
        rigid.velocity += m[c] * v[c];
    }
    rigid.centre /= mass;
    rigid.velocity /= mass;

    // Inertia I = Σ m (r² 1 - r rᵀ) and angular momentum L = Σ m r × v about the centre; I spin = L.
    std::array<Vec3p, 3> rr{}, rv{};  // columns of Σ m r rᵀ and Σ m r vᵀ
    for (int c = begin; c < end; ++c) {
        const Vec3p r = x[c] - rigid.centre, u = v[c] - rigid.velocity, mr = m[c] * r;
        for (int k = 0; k < 3; ++k) {
            rr[k] += r[k] * mr;
            rv[k] += u[k] * mr;
        }
    }
    const Vec3 L(rv[2][1] - rv[1][2], rv[0][2] - rv[2][0], rv[1][0] - rv[0][1]);
    Mat3 second_moment;
    second_moment << unpadded(rr[0]), unpadded(rr[1]), unpadded(rr[2]);
    const Mat3 inertia = second_moment.trace() * Mat3::Identity() - second_moment;
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(inertia);
    for (int k = 0; k < 3; ++k) {
        const Vec3 axis = principal.eigenvectors().col(k);
        const double about_axis = principal.eigenvalues()[k];
        if (about_axis > mass * thin * thin)
            rigid.inverse_inertia += axis * axis.transpose() / about_axis;
    }
    rigid.spin = padded(Vec3(rigid.inverse_inertia * L));
    return rigid;
}

}  // namespace sim
