#include "sim/overlap.h"

#include "assets/base/error.h"
#include "sim/assembly.h"

#include <fmt/format.h>

namespace sim {

namespace {

constexpr double allowed = 0.05;  // in domain edges

/// (#C) 1 where a pin holds.
std::vector<char> held_by_pins(const Assembly& assembly) {
    std::vector<char> held(assembly.n_corners(), 0);
    for (const AssembledPin& pin : assembly.pins)
        for (const auto* corners : {&pin.corners, &pin.points})
            for (const int c : *corners)
                held[c] = 1;
    return held;
}

}  // namespace

void refuse_overlap(const Scene& scene,
                    const Assembly& assembly,
                    const ColliderContact& colliders,
                    const Field& x,
                    double time) {
    const ColliderContact::Penetration found =
        colliders.deepest_penetration(x, time, held_by_pins(assembly));
    if (!(found.share > allowed))
        return;
    const std::string& name = scene.bodies[assembly.body_of(found.corner)].name;
    const Vec3 at = unpadded(x[found.corner]);
    throw assets::Error(
        assets::ErrorKind::Input,
        fmt::format("body \"{}\" starts inside collider {}: by {:.3g} m at "
                    "({:.4g}, {:.4g}, {:.4g}), {:.2g} of a domain's edge; {} are allowed. "
                    "Move the body or the collider, or pin what is inside",
                    name,
                    found.collider + 1,
                    found.depth,
                    at.x(),
                    at.y(),
                    at.z(),
                    found.share,
                    allowed),
        "body." + name);
}

}  // namespace sim
