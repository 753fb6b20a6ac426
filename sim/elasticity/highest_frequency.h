// How fast a body's corners can swing: what explicit steps have to follow.
#pragma once

#include "sim/elasticity/elastic_energy.h"
#include "sim/lattice/lattice.h"

namespace sim {

/// w of the fastest mode at rest, K u = w² M u, with the masses of the lattice's corners, by the power method: see
/// fastest_mode(). Slaved corners swing no faster, as their nodes carry their mass whole. [rad/s]
///
/// The element bound w² <= 4 (3λ+2μ)/(rho s²) (Irons) is a third too high in most bodies: it is that of a single domain
/// that breathes, which its neighbours do not let it.
///
/// Linearises `energy` at rest.
double highest_frequency(ElasticEnergy& energy, const Lattice& lattice);

}  // namespace sim
