#include "sim/contact/point_grid.h"

namespace sim {

namespace {

constexpr double most_cells_per_point = 16;

}  // namespace

PointGrid::PointGrid(const std::vector<Vec3>& points, double cell) : cell_(cell) {
    start_.assign(1, 0);
    if (points.empty())
        return;
    Vec3 high = low_ = points.front();
    for (const Vec3& x : points) {
        low_ = low_.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    double total = 0;
    for (;; cell_ *= 2) {
        const Vec3 n = ((high - low_) / cell_).array().floor() + 1;
        total = n.prod();
        if (total > most_cells_per_point * static_cast<double>(points.size()) + 64)
            continue;
        for (int k = 0; k < 3; ++k)
            n_[k] = static_cast<int>(n[k]);
        break;
    }
    std::vector<int> cell_of(points.size());
    start_.assign(static_cast<std::size_t>(total) + 1, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 at = (points[i] - low_) / cell_;
        cell_of[i] = int(at[0]) + n_[0] * (int(at[1]) + n_[1] * int(at[2]));
        ++start_[cell_of[i] + 1];
    }
    for (std::size_t c = 1; c < start_.size(); ++c)
        start_[c] += start_[c - 1];
    sorted_.resize(points.size());
    std::vector<int> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i)
        sorted_[next[cell_of[i]]++] = static_cast<int>(i);
}

}  // namespace sim
