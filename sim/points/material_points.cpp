#include "sim/points/material_points.h"

namespace sim {

MaterialPoints seed_points(const Lattice& lattice, const Body& body) {
    MaterialPoints points;
    points.spacing = lattice.edge;
    points.rest = lattice.filled_centre;
    points.mu = lattice.mu;
    points.lambda = lattice.lambda;
    points.region = lattice.region;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        points.volume.push_back(lattice.domain_volume(p));
        points.mass.push_back(lattice.density[p] * lattice.domain_volume(p));
    }
    for (const Region& region : body.regions) {
        points.model.push_back(region.model);
        points.snow.push_back(region.snow);
    }
    return points;
}

}  // namespace sim
