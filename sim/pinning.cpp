#include "sim/pinning.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <variant>

namespace sim {

namespace {

constexpr double time_rounding = 1e-9;  // [s], far below any step

}  // namespace

bool is_in_force(const Pin& pin, double time) {
    return time <= pin.until - time_rounding;
}

Vec3 pinned_position(const Pin& pin, const Vec3& X, double time) {
    if (const auto* velocity = std::get_if<Pin::Velocity>(&pin.moves))
        return X + time * velocity->velocity;
    if (const auto* spin = std::get_if<Pin::Spin>(&pin.moves))
        return spin->point
               + Eigen::AngleAxisd(spin->rate * time, spin->axis.normalized())
                     * (X - spin->point);
    return X;
}

void prescribe(const Scene& scene,
               const Assembly& assembly,
               double time_begin,
               double time_end,
               Prescribed& prescribed) {
    auto& [is_free, target, holder, corners] = prescribed;
    is_free.resize(assembly.n_corners(), Vec3p{1, 1, 1, 0});
    target.resize(assembly.n_corners());
    holder.resize(assembly.n_corners(), held_by_none);
    for (const int c : corners) {
        is_free[c] = Vec3p{1, 1, 1, 0};
        holder[c] = held_by_none;
    }
    corners.clear();
    for (std::size_t k = 0; k < scene.pins.size(); ++k) {
        const Pin& pin = scene.pins[k];
        if (!is_in_force(pin, time_begin))
            continue;
        for (const int c : assembly.pins[k].corners) {
            const Vec3 to =
                pinned_position(pin, unpadded(assembly.rest[c]), std::min(time_end, pin.until));
            if (holder[c] == held_by_none)
                corners.push_back(c);
            for (int axis = 0; axis < 3; ++axis)
                if (pin.only[axis]) {
                    is_free[c][axis] = 0;
                    target[c][axis] = to[axis];
                    holder[c][axis] = static_cast<int>(k);
                }
        }
    }
    std::sort(corners.begin(), corners.end());
}

}  // namespace sim
