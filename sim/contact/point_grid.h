// Points sorted into a regular grid of cells, to be found by place.
#pragma once

#include "assets/base/vector_types.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sim {

class PointGrid {
  public:
    /// Cells of edge `cell` [m], more where the points spread over very many.
    PointGrid(const std::vector<Vec3>& points, double cell);

    /// visit(index) for all points in the 27 cells around x: those within `cell` of it are among them.
    template <class Visit>
    void near(const Vec3& x, const Visit& visit) const {
        std::array<int, 3> low, high;
        for (int k = 0; k < 3; ++k) {
            const double at = std::floor((x[k] - low_[k]) / cell_);
            low[k] = static_cast<int>(std::clamp(at - 1, 0.0, double(n_[k])));
            high[k] = static_cast<int>(std::clamp(at + 1, -1.0, double(n_[k]) - 1));
        }
        for (int k = low[2]; k <= high[2]; ++k)
            for (int j = low[1]; j <= high[1]; ++j)
                for (int i = low[0]; i <= high[0]; ++i) {
                    const int c = i + n_[0] * (j + n_[1] * k);
                    for (int s = start_[c]; s < start_[c + 1]; ++s)
                        visit(sorted_[s]);
                }
    }

  private:
    Vec3 low_{0, 0, 0};
    double cell_ = 0;
    std::array<int, 3> n_{0, 0, 0};
    std::vector<int> start_, sorted_;  // (#cells + 1), (#points) ascending within a cell
};

}  // namespace sim
