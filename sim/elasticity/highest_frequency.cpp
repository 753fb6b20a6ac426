#include "sim/elasticity/highest_frequency.h"

#include "sim/elasticity/power_method.h"

#include <random>

namespace sim {

namespace {

/// Neighbours that move against each other, as in the fastest modes, and something of all others.
Field first_guess(const Lattice& lattice) {
    std::mt19937 random(1);
    const auto number = [&] { return random() / double(std::mt19937::max()); };
    Field u;
    for (const auto& [i, j, k] : lattice.corner_cell)
        u.push_back(((i + j + k) % 2 ? -1.0 : 1.0) * Vec3p{number(), number(), number(), 0});
    return u;
}

}  // namespace

double highest_frequency(ElasticEnergy& energy, const Lattice& lattice) {
    Field x;
    for (const Vec3& X : lattice.corner_rest)
        x.push_back(padded(X));
    energy.linearize(x.data(), true);
    return fastest_mode(
        first_guess(lattice), lattice.corner_mass, [&](const Field& u, Field& Ku) {
            energy.product(u.data(), Ku.data());
        });
}

}  // namespace sim
