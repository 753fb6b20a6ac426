// Vertices of a body's surface sorted into a regular grid of cells, to be looked at four side by side.
#pragma once

#include "sim/contact/contact_surface.h"
#include "sim/contact/padded_bounds.h"

#include <array>
#include <cstring>
#include <vector>

namespace sim {

class VertexGrid {
  public:
    explicit VertexGrid(const ContactSurface& surface);

    /// Where the vertices are now, from values of the corners of the body.   (#corners) [m]
    void place(const ContactSurface& surface, const Field& corners);

    const Vec3p& at(int vertex) const { return at_[vertex]; }

    /// visit(vertex) for those no further from a box than `within`, along its axes, that are about `least` or more from `centre`
    /// at rest: all of those, and none that is nearer to it by more than rounding.   [m]
    template <class Visit>
    void for_strangers_near(const PaddedBounds& box,
                            double within,
                            const Vec3& centre,
                            double least,
                            const Visit& visit) const {
        constexpr double rounding = 1e-9;  // of squared distances
        const double least_squared = least * least * (1 - rounding);
        const std::array<int, 3> low = cell_of(box.low - within),
                                 high = cell_of(box.high + within);
        for (int k = low[2]; k <= high[2]; ++k)
            for (int j = low[1]; j <= high[1]; ++j) {
                const int row = n_[0] * (j + n_[1] * k), end = start_[row + high[0] + 1];
                for (int s = start_[row + low[0]]; s < end; s += 4) {
                    const Vec3p gap = larger(larger(outside(0, s, box), outside(1, s, box)),
                                             outside(2, s, box));
                    const Vec3p dx = four(rest_[0], s) - centre.x(),
                                dy = four(rest_[1], s) - centre.y(),
                                dz = four(rest_[2], s) - centre.z();
                    const auto met =
                        (gap <= within) & (dx * dx + dy * dy + dz * dz >= least_squared);
                    if (!(met[0] | met[1] | met[2] | met[3]))
                        continue;
                    for (int lane = 0; lane < 4 && s + lane < end; ++lane)
                        if (met[lane])
                            visit(sorted_[s + lane]);
                }
            }
    }

  private:
    using Axis = std::vector<double>;  // (#vertices + 3) sorted, so that any has three after it

    static Vec3p four(const Axis& values, int s) {
        Vec3p result;
        std::memcpy(&result, &values[s], sizeof result);
        return result;
    }

    Vec3p outside(int axis, int s, const PaddedBounds& box) const {
        const Vec3p x = four(now_[axis], s);
        return larger(box.low[axis] - x, x - box.high[axis]);
    }

    /// The nearest to x.
    std::array<int, 3> cell_of(const Vec3p& x) const {
        const Vec3p cell = (x - low_) / cell_;
        std::array<int, 3> result;
        for (int axis = 0; axis < 3; ++axis)
            result[axis] = static_cast<int>(std::clamp(cell[axis], 0.0, n_[axis] - 1.0));
        return result;
    }

    void choose_cells(const PaddedBounds& bounds);
    void sort(const ContactSurface& surface);

    double least_cell_ = 0, cell_ = 0;  // [m]
    Vec3p low_{};
    std::array<int, 3> n_{1, 1, 1};
    Field at_;  // (#vertices) [m]
    std::vector<int> start_, sorted_,
        of_;                          // (#cells + 1), (#vertices), the cell of each vertex
    std::array<Axis, 3> now_, rest_;  // [m]
};

}  // namespace sim
