#include "sim/enrichment/interface_enrichment.h"

#include "assets/base/error.h"

#include <cmath>
#include <map>

namespace sim {

namespace {

constexpr double most_cells = 1 << 28;

Vec3p centre(const Lattice& lattice, int p, const Vec3p* corners) {
    Vec3p sum{};
    for (const int c : lattice.corners[p])
        sum += corners[c];
    return sum * 0.125;
}

}  // namespace

std::vector<int> boundary_domains(const Lattice& lattice) {
    std::map<std::array<int, 3>, int> domain_at;
    for (int p = 0; p < lattice.n_domains(); ++p)
        domain_at[lattice.cell[p]] = p;
    std::vector<int> boundary;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        bool differs = false;
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) {
                std::array<int, 3> neighbour = lattice.cell[p];
                neighbour[axis] += side;
                const auto found = domain_at.find(neighbour);
                differs |= found != domain_at.end()
                           && lattice.region[found->second] != lattice.region[p];
            }
        if (differs)
            boundary.push_back(p);
    }
    return boundary;
}

InterfaceEnrichment::InterfaceEnrichment(const Lattice& lattice, double cell_size)
    : boundary_(boundary_domains(lattice)), cell_size_(cell_size) {
    enriched_.assign(lattice.n_domains(), 0);
    cell_of_domain_.resize(lattice.n_domains());
}

void InterfaceEnrichment::update(const Lattice& lattice, const Vec3p* corners, char* free) {
    if (boundary_.empty())
        return;
    // The background cell of every domain's centre, and their box.
    Vec3p low{}, high{};
    for (int p = 0; p < lattice.n_domains(); ++p) {
        const Vec3p scaled = centre(lattice, p, corners) * (1 / cell_size_);
        const Vec3p cell{
            std::floor(scaled[0]), std::floor(scaled[1]), std::floor(scaled[2]), 0};
        cell_of_domain_[p] = cell;
        if (p == 0)
            low = high = cell;
        low = cell < low ? cell : low;
        high = cell > high ? cell : high;
    }
    const Vec3p n = high - low + 1.0;
    if (!(n[0] * n[1] * n[2] < most_cells))
        throw assets::Error(
            assets::ErrorKind::Diverged,
            "a body spreads over more background cells than can be held; it has flown apart");
    const auto index = [&](const Vec3p& cell) {
        const Vec3p local = cell - low;
        return static_cast<std::size_t>(local[0] + n[0] * (local[1] + n[1] * local[2]));
    };

    marked_.assign(static_cast<std::size_t>(n[0] * n[1] * n[2]), 0);
    for (const int p : boundary_)
        marked_[index(cell_of_domain_[p])] = 1;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        enriched_[p] = marked_[index(cell_of_domain_[p])];
        if (enriched_[p])
            for (const int c : lattice.corners[p])
                free[c] = 1;
    }
}

}  // namespace sim
