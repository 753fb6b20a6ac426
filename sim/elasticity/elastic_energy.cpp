#include "sim/elasticity/elastic_energy.h"

#include "sim/elasticity/eight_point.h"
#include "sim/elasticity/elasticity.h"

namespace sim {

std::unique_ptr<ElasticEnergy> make_elastic_energy(const Lattice& lattice,
                                                   const Body& body,
                                                   Quadrature quadrature) {
    if (quadrature == Quadrature::EightPoint)
        return std::make_unique<EightPoint>(lattice, body);
    return std::make_unique<Elasticity>(lattice, body);
}

}  // namespace sim
