#include "sim/contact/pair_friction.h"

namespace sim {

PairFriction::PairFriction(const Scene& scene)
    : n_bodies_(scene.bodies.size()), of_pair_(n_bodies_ * n_bodies_, scene.contact.friction) {
    const auto is_pair = [&](const ContactPair& pair, std::size_t a, std::size_t b) {
        return pair.bodies[0] == scene.bodies[a].name && pair.bodies[1] == scene.bodies[b].name;
    };
    for (const ContactPair& pair : scene.contact.pairs)
        for (std::size_t a = 0; a < n_bodies_; ++a)
            for (std::size_t b = 0; b < n_bodies_; ++b)
                if (is_pair(pair, a, b) || is_pair(pair, b, a))
                    of_pair_[a * n_bodies_ + b] = pair.friction;
}

}  // namespace sim
