// Fixed-size vectors and matrices shared by every part. SI units unless a name says otherwise.
#pragma once

#include <Eigen/Core>

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec9 = Eigen::Matrix<double, 9, 1>;
using Mat9 = Eigen::Matrix<double, 9, 9>;
using Vec3f = Eigen::Vector3f;

/// vec(A): the columns of A stacked, so vec(A)[3j + i] = A(i, j).
inline Vec9 vec(const Mat3& A) {
    return Eigen::Map<const Vec9>(A.data());
}
