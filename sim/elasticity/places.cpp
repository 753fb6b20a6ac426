#include "sim/elasticity/places.h"

#include "sim/materials/lanes.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace sim {

Range cell_range(const Lattice& lattice, const std::vector<int>& domains) {
    Range range{lattice.cell[domains.front()], lattice.cell[domains.front()]};
    for (const int p : domains)
        for (int k = 0; k < 3; ++k) {
            range.low[k] = std::min(range.low[k], lattice.cell[p][k]);
            range.high[k] = std::max(range.high[k], lattice.cell[p][k]);
        }
    return range;
}

Range cell_range(const Lattice& lattice) {
    std::vector<int> all(lattice.n_domains());
    std::iota(all.begin(), all.end(), 0);
    return cell_range(lattice, all);
}

Places best_places(const Lattice& lattice, const std::vector<int>& domains) {
    const Range range = cell_range(lattice, domains);
    const auto n_batches = [&](const Places& places) {
        std::set<int> batches;
        for (const int p : domains)
            batches.insert(places.of(lattice.cell[p]) / lane_count);
        return batches.size();
    };
    Places best(range, 0);
    for (const int axis : {1, 2})
        if (const Places places(range, axis); n_batches(places) < n_batches(best))
            best = places;
    return best;
}

}  // namespace sim
