// Vertices of a body's surface that are near each other at rest, four side by side.
#pragma once

#include "sim/contact/contact_surface.h"
#include "sim/contact/padded_bounds.h"

#include <vector>

namespace sim {

struct VertexBlock {
    /// Four points, an axis each.   [m]
    struct Four {
        Vec3p x{}, y{}, z{};
    };

    VertexBlock(const ContactSurface& surface, std::vector<int> of_surface);

    std::vector<int> vertices;  // of the surface
    std::vector<int> carriers;  // ascending, corners of the body that carry them
    std::vector<Four> rest,
        now;              // (#vertices / 4) of the vertices in their order, the last repeated
    PaddedBounds bounds;  // now

    /// Where they are now, from values of the corners of the body.   [m]
    void place(const ContactSurface& surface, const Field& corners);

    Vec3p at(int k) const {
        const Four& four = now[k / 4];
        return Vec3p{four.x[k % 4], four.y[k % 4], four.z[k % 4], 0};
    }

    /// visit(k) for the vertices closer to a box than `within`, along its axes, that are about `least` or more from
    /// `centre` at rest: all of those, and none that is nearer to it by more than rounding.   [m]
    template <class Visit>
    void for_strangers_near(const PaddedBounds& box,
                            double within,
                            const Vec3& centre,
                            double least,
                            const Visit& visit) const {
        constexpr double rounding = 1e-9;  // of squared distances
        const double least_squared = least * least * (1 - rounding);
        const int n = static_cast<int>(vertices.size());
        for (int four = 0; 4 * four < n; ++four) {
            const Four &x = now[four], &X = rest[four];
            const Vec3p gap = larger(larger(outside(x.x, box.low[0], box.high[0]),
                                            outside(x.y, box.low[1], box.high[1])),
                                     outside(x.z, box.low[2], box.high[2]));
            const Vec3p dx = X.x - centre.x(), dy = X.y - centre.y(), dz = X.z - centre.z();
            const auto met = (gap < within) & (dx * dx + dy * dy + dz * dz >= least_squared);
            if (!(met[0] | met[1] | met[2] | met[3]))
                continue;
            for (int lane = 0; lane < 4 && 4 * four + lane < n; ++lane)
                if (met[lane])
                    visit(4 * four + lane);
        }
    }

  private:
    static Vec3p outside(const Vec3p& x, double low, double high) {
        return larger(low - x, x - high);
    }
};

}  // namespace sim
