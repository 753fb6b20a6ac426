#include "sim/elasticity/elastic_energy.h"

#include "sim/elasticity/eight_point.h"
#include "sim/elasticity/elasticity.h"

#include <algorithm>

namespace sim {

std::vector<double> wave_compliances(const Lattice& lattice) {
    double fastest = 0;  // c² = (λ+2μ)/rho  [m²/s²]
    for (int p = 0; p < lattice.n_domains(); ++p)
        fastest =
            std::max(fastest, (lattice.lambda[p] + 2 * lattice.mu[p]) / lattice.density[p]);
    std::vector<double> compliances;
    for (const double density : lattice.density)
        compliances.push_back(1 / (density * fastest));
    return compliances;
}

std::unique_ptr<ElasticEnergy> make_elastic_energy(const Lattice& lattice,
                                                   const Body& body,
                                                   Quadrature quadrature) {
    if (quadrature == Quadrature::EightPoint)
        return std::make_unique<EightPoint>(lattice, body);
    return std::make_unique<Elasticity>(lattice, body);
}

}  // namespace sim
