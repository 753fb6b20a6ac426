// What points know, told to places near them: to the vertices of their surface.
#pragma once

#include "assets/base/vector_types.h"

#include <cstddef>
#include <vector>

namespace assets {

class PointValues {
  public:
    /// Weighs the points around each place by (1 - d²/R²)³, R = 2 spacings. std::logic_error where a place has no
    /// point that near.
    PointValues(const std::vector<Vec3>& points,
                double spacing,
                const std::vector<Vec3f>& places);

    /// Weighted mean at each place of a value per point; T is a float or a vector of floats.
    template <class T>
    std::vector<T> mean(const std::vector<T>& of_points) const {
        std::vector<T> result;
        result.reserve(nearest_.size());
        for (std::size_t v = 0; v < nearest_.size(); ++v) {
            T sum = of_points[nearest_[v]] * 0.0f;
            for (std::size_t i = begin_[v]; i < begin_[v + 1]; ++i)
                sum += of_points[shares_[i].point] * shares_[i].weight;
            result.push_back(sum);
        }
        return result;
    }

    /// The value of the nearest point at each place, for what has no mean: names, indices.
    template <class T>
    std::vector<T> nearest(const std::vector<T>& of_points) const {
        std::vector<T> result;
        result.reserve(nearest_.size());
        for (const int point : nearest_)
            result.push_back(of_points[point]);
        return result;
    }

  private:
    struct Share {
        int point;
        float weight;  // those of a place sum to 1
    };

    std::vector<Share> shares_;
    std::vector<std::size_t> begin_;  // (#places + 1) into shares_
    std::vector<int> nearest_;        // (#places)
};

}  // namespace assets
