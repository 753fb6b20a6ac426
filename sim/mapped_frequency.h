// How fast a body can swing that a map lets move.
#pragma once

#include "sim/elasticity/elastic_energy.h"
#include "sim/grid/corner_map.h"
#include "sim/lattice/lattice.h"

namespace sim {

/// w of the fastest mode at rest of a body whose corners, from `first_corner` on, are body `body` of the map:
/// TᵀK T q = w² M q with M = Tᵀm lumped. Never above that of K u = w² m u, as by Jensen Σ_c m_c |T q|_c² <= Σ_i M_i |q_i|².
/// By the power method, see fastest_mode(); linearises `energy` at rest.   [rad/s]
double highest_frequency(ElasticEnergy& energy,
                         const Lattice& lattice,
                         const CornerMap& map,
                         int body,
                         int first_corner);

}  // namespace sim
