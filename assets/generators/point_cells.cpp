#include "assets/generators/point_cells.h"

#include "assets/base/error.h"

#include <algorithm>

namespace assets {

PointCells::PointCells(const std::vector<Vec3>& points, double cell)
    : points_(points), cell_(cell) {
    std::vector<std::pair<std::uint64_t, int>> keys;
    keys.reserve(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
        check((points[p] / cell).cwiseAbs().maxCoeff() < 1e6,
              "a point lies within a million cells of the origin");
        keys.emplace_back(key(index(points[p])), static_cast<int>(p));
    }
    std::sort(keys.begin(), keys.end());
    for (const auto& [cell_key, point] : keys) {
        const int at = static_cast<int>(order_.size());
        order_.push_back(point);
        ranges_.try_emplace(cell_key, at, at).first->second.second = at + 1;
    }
}

}  // namespace assets
