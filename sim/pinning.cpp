#include "sim/pinning.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <variant>

namespace sim {

namespace {

constexpr double time_rounding = 1e-9;  // [s], far below any step

}  // namespace

Vec3 pinned_position(const Pin& pin, const Vec3& X, double time) {
    if (const auto* velocity = std::get_if<Pin::Velocity>(&pin.moves))
        return X + time * velocity->velocity;
    if (const auto* spin = std::get_if<Pin::Spin>(&pin.moves))
        return spin->point
               + Eigen::AngleAxisd(spin->rate * time, spin->axis.normalized())
                     * (X - spin->point);
    return X;
}

Prescribed prescribe(const Scene& scene,
                     const Assembly& assembly,
                     double time_begin,
                     double time_end) {
    const int n = assembly.n_corners();
    Prescribed result;
    result.is_free.assign(n, Vec3p{1, 1, 1, 0});
    result.target = assembly.rest;
    result.holder.assign(n, -1);
    for (std::size_t k = 0; k < scene.pins.size(); ++k) {
        const Pin& pin = scene.pins[k];
        if (time_begin > pin.until - time_rounding)
            continue;
        for (const int c : assembly.pins[k].corners) {
            const Vec3 target =
                pinned_position(pin, unpadded(assembly.rest[c]), std::min(time_end, pin.until));
            for (int axis = 0; axis < 3; ++axis)
                if (pin.only[axis]) {
                    result.is_free[c][axis] = 0;
                    result.target[c][axis] = target[axis];
                }
            if (result.holder[c] < 0)
                result.corners.push_back(c);
            result.holder[c] = static_cast<int>(k);
        }
    }
    std::sort(result.corners.begin(), result.corners.end());
    return result;
}

}  // namespace sim
