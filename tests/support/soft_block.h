// Bodies of one stable material and a density of 1000 kg/m³, for contact.
#pragma once

#include "sim/simulation.h"

namespace tests {

inline sim::Body soft_body(const char* name,
                           const assets::Shape& shape,
                           double edge,
                           double E) {
    sim::Body body;
    body.name = name;
    body.domain_size = edge;
    body.source.geometry = shape;
    body.skins.push_back({"outside", {}});
    sim::Region region;
    region.name = "all";
    region.select.is = sim::Selector::All{};
    region.model = sim::Model::StableNeoHookean;
    region.young_modulus = E;
    region.poisson_ratio = 0.3;
    region.density = 1000;
    body.regions.push_back(region);
    return body;
}

inline sim::Body soft_block(
    const char* name, const Vec3& low, const Vec3& size, double edge, double E) {
    return soft_body(name, assets::Box{low, low + size}, edge, E);
}

inline sim::Body soft_cube(
    const char* name, const Vec3& low, double side, int n_domains, double E) {
    return soft_block(name, low, Vec3::Constant(side), side / n_domains, E);
}

/// Holds what of a body stands on z = 0.
inline sim::Pin foot_of(const char* body) {
    sim::Pin foot;
    foot.name = "foot";
    foot.body = body;
    foot.select.is = sim::Selector::HalfSpace{{0, 0, 0.001}, {0, 0, 1}};
    return foot;
}

/// What a step may not add to, but for the energy of contact itself.   [J]
inline double energy(const sim::Stats& stats) {
    return stats.kinetic_energy + stats.elastic_energy + stats.gravitational_energy;
}

}  // namespace tests
