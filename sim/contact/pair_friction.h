// Friction between two bodies of a scene.
#pragma once

#include "sim/scene.h"

namespace sim {

/// That of the last [[contact.pair]] that names both bodies, in any order, else that of [contact].
class PairFriction {
  public:
    explicit PairFriction(const Scene& scene);

    const Friction& between(int body_a, int body_b) const {
        return of_pair_[static_cast<std::size_t>(body_a) * n_bodies_ + body_b];
    }

  private:
    std::size_t n_bodies_ = 0;
    std::vector<Friction> of_pair_;  // (#bodies × #bodies), symmetric
};

}  // namespace sim
