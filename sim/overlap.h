// Bodies that a shot puts into colliders.
#pragma once

#include "sim/contact/collider_contact.h"
#include "sim/scene.h"

namespace sim {

struct Assembly;

/// Throws Error(Input), with the body's key, where a corner or point at x (#C) that no pin holds lies inside a collider at
/// `time` by more than a twentieth of a domain: contact would throw it out, with energy that nothing has put in. Less is
/// what level sets of meshes miss by where bodies just touch.
void refuse_overlap(const Scene& scene,
                    const Assembly& assembly,
                    const ColliderContact& colliders,
                    const Field& x,
                    double time);

}  // namespace sim
