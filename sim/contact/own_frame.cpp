#include "sim/contact/own_frame.h"

#include "sim/materials/signed_svd.h"

#include <cmath>

namespace sim {

double OwnFrame::turn_from(const OwnFrame& other) const {
    // The difference of two rotations stretches all that is across their axis by the same, and nothing along it.
    double squared = 0;
    for (int k = 0; k < 3; ++k)
        squared += dot(column[k] - other.column[k], column[k] - other.column[k]);
    return std::sqrt(squared / 2);
}

OwnFrame FrameSums::frame(std::size_t n_corners) const {
    Mat3 covariance;
    covariance << unpadded(column_[0]), unpadded(column_[1]), unpadded(column_[2]);
    const auto [U, stretch, V] = signed_svd(covariance);
    const Mat3 inverse = V * U.transpose();
    OwnFrame frame;
    frame.centre = sum_ / double(n_corners);
    for (int k = 0; k < 3; ++k)
        frame.column[k] = padded(inverse.col(k));
    return frame;
}

}  // namespace sim
