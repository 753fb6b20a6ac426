#include "sim/materials/signed_svd.h"

#include "assets/base/error.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace sim {

SignedSvd signed_svd(const Mat3& F) {
    assets::check(F.allFinite(), "signed_svd: F is finite");
    const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    SignedSvd result{svd.matrixU(), svd.singularValues(), svd.matrixV()};
    // A reflection on either side is moved into the smallest stretch, where it costs the least energy.
    for (Mat3* const side : {&result.U, &result.V}) {
        if (side->determinant() < 0) {
            side->col(2) *= -1;
            result.sigma[2] *= -1;
        }
    }
    return result;
}

}  // namespace sim
