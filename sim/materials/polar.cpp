#include "sim/materials/polar.h"

#include "sim/materials/signed_svd.h"

namespace sim {

Matrix3<double> nearest_rotation_by_svd(const Matrix3<double>& F) {
    const Eigen::Map<const Mat3> f(F.m);
    Matrix3<double> R;
    Eigen::Map<Mat3> r(R.m);
    if (f.allFinite()) {
        const SignedSvd svd = signed_svd(f);
        r = svd.U * svd.V.transpose();
    } else {
        r.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    return R;
}

}  // namespace sim
