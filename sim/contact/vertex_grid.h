// Vertices of a body's surface sorted into a regular grid of cells, to be looked at eight side by side.
#pragma once

#include "sim/contact/contact_surface.h"
#include "sim/contact/padded_bounds.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <immintrin.h>
#include <vector>

namespace sim {

class VertexGrid {
  public:
    explicit VertexGrid(const ContactSurface& surface);

    /// Where the vertices are now, from values of the corners of the body.   (#corners) [m]
    void place(const ContactSurface& surface, const Field& corners);

    const Vec3p& at(int vertex) const { return at_[vertex]; }

    /// visit(vertex) for those no further from a box than `within`, along its axes, that are `least` or more from `centre`
    /// at rest: all of those, and others only by what single precision rounds.   [m]
    template <class Visit>
    void for_strangers_near(const PaddedBounds& box,
                            double within,
                            const Vec3& centre,
                            double least,
                            const Visit& visit) const {
        const std::array<int, 3> first = cell_of(box.low - within),
                                 last = cell_of(box.high + within);
        const Vec3p low = box.low - low_ - (within + rounding_),
                    high = box.high - low_ + (within + rounding_),
                    from = padded(centre) - rest_low_;
        const float least_squared = static_cast<float>(square(least - rounding_));
        for (int k = first[2]; k <= last[2]; ++k)
            for (int j = first[1]; j <= last[1]; ++j) {
                const int row = n_[0] * (j + n_[1] * k), end = start_[row + last[0] + 1];
                for (int s = start_[row + first[0]]; s < end; s += n_lanes) {
                    const Eight dx = eight(rest_[0], s) - static_cast<float>(from[0]),
                                dy = eight(rest_[1], s) - static_cast<float>(from[1]),
                                dz = eight(rest_[2], s) - static_cast<float>(from[2]);
                    const auto met = is_between(0, s, low, high) & is_between(1, s, low, high)
                                     & is_between(2, s, low, high)
                                     & (dx * dx + dy * dy + dz * dz >= least_squared);
                    for (unsigned lanes = lanes_of(met, end - s); lanes != 0;
                         lanes &= lanes - 1)
                        visit(sorted_[s + std::countr_zero(lanes)]);
                }
            }
    }

  private:
    static constexpr int n_lanes = 8;
    using Eight [[gnu::vector_size(4 * n_lanes)]] = float;
    using Mask [[gnu::vector_size(4 * n_lanes)]] = int;
    using Axis = std::vector<float>;  // (#vertices + 7) sorted, so that any has seven after it

    static double square(double x) { return x * x; }

    static Eight eight(const Axis& values, int s) {
        Eight result;
        std::memcpy(&result, &values[s], sizeof result);
        return result;
    }

    Mask is_between(int axis, int s, const Vec3p& low, const Vec3p& high) const {
        const Eight x = eight(now_[axis], s);
        return (x >= static_cast<float>(low[axis])) & (x <= static_cast<float>(high[axis]));
    }

    /// A bit for each of the first n lanes that is set.
    static unsigned lanes_of(const Mask& mask, int n) {
        const auto bits =
            static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(__m256i(mask))));
        return n < n_lanes ? bits & ((1U << n) - 1) : bits;
    }

    /// The nearest to x.
    std::array<int, 3> cell_of(const Vec3p& x) const {
        const Vec3p cell = smaller(larger((x - low_) * inverse_cell_, Vec3p{}), last_);
        return {
            static_cast<int>(cell[0]), static_cast<int>(cell[1]), static_cast<int>(cell[2])};
    }

    void choose_cells(const PaddedBounds& bounds);
    void sort(const ContactSurface& surface);

    double least_cell_ = 0, rest_extent_ = 0;  // [m]
    double inverse_cell_ = 0;                  // [1/m]
    double rounding_ = 0;  // of a difference of two places in single precision, at most [m]
    Vec3p low_{}, rest_low_{};
    std::array<int, 3> n_{1, 1, 1};  // cells
    Vec3p last_{};                   // of them
    Field at_;                       // (#vertices) [m]
    std::vector<int> start_, sorted_,
        of_;                          // (#cells + 1), (#vertices), the cell of each vertex
    std::array<Axis, 3> now_, rest_;  // from low_ and rest_low_ on [m]
};

}  // namespace sim
