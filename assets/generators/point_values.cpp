#include "assets/generators/point_values.h"

#include "assets/base/error.h"
#include "assets/generators/point_cells.h"

#include <limits>

namespace assets {

PointValues::PointValues(const std::vector<Vec3>& points,
                         double spacing,
                         const std::vector<Vec3f>& places) {
    const double reach = 2 * spacing;
    const PointCells cells(points, reach);
    begin_.push_back(0);
    for (const Vec3f& place : places) {
        const Vec3 x = place.cast<double>();
        double sum = 0, least = std::numeric_limits<double>::infinity();
        nearest_.push_back(-1);
        cells.in_box(x - Vec3::Constant(reach), x + Vec3::Constant(reach), [&](int p) {
            const double share = 1 - (points[p] - x).squaredNorm() / (reach * reach);
            if (!(share > 0))
                return;
            const double weight = share * share * share;
            shares_.push_back({p, static_cast<float>(weight)});
            sum += weight;
            if (1 - share < least) {
                least = 1 - share;
                nearest_.back() = p;
            }
        });
        check(sum > 0, "a place has points around it");
        for (std::size_t i = begin_.back(); i < shares_.size(); ++i)
            shares_[i].weight /= static_cast<float>(sum);
        begin_.push_back(shares_.size());
    }
}

}  // namespace assets
