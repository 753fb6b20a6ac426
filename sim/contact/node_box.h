// Numbers for the nodes of a grid that a few bodies share.
#pragma once

#include "sim/base/cell_box.h"

#include <array>
#include <cmath>
#include <vector>

namespace sim {

/// The nodes of a box, by their integer coordinates; -1 where none is numbered.
class NodeBox {
  public:
    /// Those that quadratic stencils of points between two ends reach, cells being h wide.   [m]
    /// Throws FlownApart.
    NodeBox(const Vec3p& low_end, const Vec3p& high_end, double h) {
        Vec3p size{}, sum{};
        for (int k = 0; k < 3; ++k) {
            const double low = std::floor(low_end[k] / h) - 1,
                         high = std::floor(high_end[k] / h) + 2;
            low_[k] = static_cast<long>(low);
            n_[k] = static_cast<long>(high - low + 1);
            size[k] = high - low + 1;
            sum[k] = low + high;
        }
        check_spread(size, sum);
        number_.assign(static_cast<std::size_t>(size[0] * size[1] * size[2]), -1);
    }

    int& operator()(long i, long j, long k) {
        return number_[(i - low_[0]) + n_[0] * ((j - low_[1]) + n_[1] * (k - low_[2]))];
    }

  private:
    std::array<long, 3> low_{}, n_{};
    std::vector<int> number_;
};

}  // namespace sim
