// Points sorted into cubic cells, to find those near a place.
#pragma once

#include "assets/base/vector_types.h"

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace assets {

class PointCells {
  public:
    /// Keeps a reference to the points, which must live longer. std::logic_error where one lies a million cells or
    /// more from the origin.
    PointCells(const std::vector<Vec3>& points, double cell);

    /// Calls visit(p) for every point whose cell meets the box from `low` to `high`, in an order that depends on the
    /// points alone.
    template <class Visit>
    void in_box(const Vec3& low, const Vec3& high, const Visit& visit) const {
        const Index first = index(low), last = index(high);
        for (std::int64_t k = first[2]; k <= last[2]; ++k)
            for (std::int64_t j = first[1]; j <= last[1]; ++j)
                for (std::int64_t i = first[0]; i <= last[0]; ++i)
                    if (const auto range = ranges_.find(key({i, j, k})); range != ranges_.end())
                        for (int at = range->second.first; at < range->second.second; ++at)
                            visit(order_[at]);
    }

    const std::vector<Vec3>& points() const { return points_; }

  private:
    using Index = Eigen::Matrix<std::int64_t, 3, 1>;

    Index index(const Vec3& x) const {
        return (x / cell_).array().floor().matrix().cast<std::int64_t>();
    }

    static std::uint64_t key(const Index& index) {
        constexpr std::int64_t middle = 1 << 20;
        const auto part = [&](int axis) {
            return static_cast<std::uint64_t>(index[axis] + middle);
        };
        return part(0) | part(1) << 21 | part(2) << 42;
    }

    const std::vector<Vec3>& points_;
    double cell_;
    std::vector<int> order_;  // points, by cell, then by index
    // Cell -> its part of order_.
    std::unordered_map<std::uint64_t, std::pair<int, int>> ranges_;
};

}  // namespace assets
