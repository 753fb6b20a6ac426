#include "sim/enrichment/enrichment.h"

#include "sim/base/cell_box.h"
#include "sim/base/floor.h"
#include "sim/enrichment/thin_domains.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <map>

namespace sim {

namespace {

constexpr double margin = 0.25;    // in cells
constexpr double least_cells = 3;  // across a part that its nodes can bend
constexpr int none = -1, several = -2;

/// Bounds of stretch under which a domain is enriched, and above which it is no longer.
struct StretchBounds {
    double smallest = 0, ratio = 0;
};

constexpr StretchBounds enter{0.5, 0.35}, leave{0.6, 0.45};

constexpr Vec3p to_all = {1, 1, 1, 0};

void meet(int& seen, int region) {
    seen = seen == none || seen == region ? region : several;
}

/// Whether domain n, beside p along an axis, has the four corners of the face between them in common with it.
bool share_face(const Lattice& lattice, int p, int n, int axis, int side) {
    for (int a = 0; a < 8; ++a)
        if ((a >> axis & 1) == side
            && lattice.corners[p][a] != lattice.corners[n][a ^ (1 << axis)])
            return false;
    return true;
}

/// Smallest and largest principal stretch of a domain's mean F.
std::pair<double, double> principal_stretches(const Lattice& lattice,
                                              int p,
                                              const Vec3p* corners) {
    Mat3 F = Mat3::Zero();
    for (int a = 0; a < 8; ++a)
        for (int j = 0; j < 3; ++j)
            F.col(j) += ((a >> j & 1) ? 0.25 : -0.25) / lattice.edge
                        * unpadded(corners[lattice.corners[p][a]]);
    Eigen::SelfAdjointEigenSolver<Mat3> solver;
    solver.computeDirect(F.transpose() * F, Eigen::EigenvaluesOnly);
    const Vec3 squared = solver.eigenvalues().cwiseMax(0);
    return {std::sqrt(squared[0]), std::sqrt(squared[2])};
}

}  // namespace

std::vector<int> boundary_domains(const Lattice& lattice) {
    // Of the domains of a cell, which follow each other.
    std::map<std::array<int, 3>, int> first_at;
    for (int p = lattice.n_domains() - 1; p >= 0; --p)
        first_at[lattice.cell[p]] = p;
    std::vector<int> boundary;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        bool differs = false;
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {0, 1}) {
                std::array<int, 3> neighbour = lattice.cell[p];
                neighbour[axis] += 2 * side - 1;
                const auto found = first_at.find(neighbour);
                if (found == first_at.end())
                    continue;
                for (int n = found->second;
                     n < lattice.n_domains() && lattice.cell[n] == neighbour;
                     ++n)
                    differs |= lattice.region[n] != lattice.region[p]
                               && share_face(lattice, p, n, axis, side);
            }
        if (differs)
            boundary.push_back(p);
    }
    return boundary;
}

Enrichment::Enrichment(const Lattice& lattice,
                       const EnrichmentCriteria& criteria,
                       double cell_size)
    : criteria_(criteria), cell_size_(cell_size) {
    is_boundary_.assign(lattice.n_domains(), 0);
    enriched_.assign(lattice.n_domains(), 0);
    bool one_region = true;
    for (const int region : lattice.region)
        one_region &= region == lattice.region.front();
    if (one_region)
        criteria_.interface = criteria_.mixed_cell = false;
    if (criteria_.interface)
        for (const int p : boundary_domains(lattice))
            is_boundary_[p] = 1;
    if (criteria_.thin)
        is_thin_ = thin_domains(lattice, least_cells / 2 * cell_size / lattice.edge);
    else
        is_thin_.assign(lattice.n_domains(), 0);
    for (int p = 0; p < lattice.n_domains(); ++p)
        if (is_boundary_[p] || criteria_.mixed_cell)
            marking_.push_back(p);
}

void Enrichment::update(const Lattice& lattice, const Vec3p* corners, char* free) {
    const bool by_cells = criteria_.interface || criteria_.mixed_cell;
    if (!by_cells && !criteria_.thin && !criteria_.strain)
        return;
    if (by_cells) {
        find_centres(lattice, corners);
        mark_cells(lattice);
    }
    for (int p = 0; p < lattice.n_domains(); ++p) {
        const bool was = enriched_[p];
        bool is = is_thin_[p];
        const int index = by_cells ? index_of(floor_of(centres_[p])) : none;
        if (by_cells && is_marked_[index]) {
            const Cell& cell = cells_[index];
            is |= cell.boundary || (was && cell.near_boundary);
            if (criteria_.mixed_cell)
                is |= cell.region == several || (was && cell.near_region == several);
        }
        if (criteria_.strain && !is) {
            const auto [smallest, largest] = principal_stretches(lattice, p, corners);
            const StretchBounds& bounds = was ? leave : enter;
            is = smallest < bounds.smallest || smallest < bounds.ratio * largest;
        }
        enriched_[p] = is;
        if (is)
            for (const int c : lattice.corners[p])
                free[c] = 1;
    }
    for (const int cell : marked_) {
        cells_[cell] = {};
        is_marked_[cell] = false;
    }
    marked_.clear();
}

void Enrichment::find_centres(const Lattice& lattice, const Vec3p* corners) {
    const int n = lattice.n_domains();
    centres_.resize(n);
    Vec3p low{}, high{},
        total{};  // not finite where a corner is not: comparisons alone would pass over it
    for (int p = 0; p < n; ++p) {
        Vec3p sum{};
        for (const int c : lattice.corners[p])
            sum += corners[c];
        const Vec3p centre = sum * (0.125 / cell_size_);
        if (p == 0)
            low = high = centre;
        low = centre < low ? centre : low;
        high = centre > high ? centre : high;
        total += centre;
        centres_[p] = centre;
    }
    low_ = floor_of(low) - to_all;  // the margin may reach one cell further
    const Vec3p size = floor_of(high) - low_ + 2 * to_all;
    check_spread(size, total);
    step_ = {1, int(size[0]), int(size[0] * size[1])};
    // Boxes around slender bodies are nearly empty: only cells that were marked are cleared.
    cells_.resize(
        std::max(cells_.size(), static_cast<std::size_t>(size[0] * size[1] * size[2])));
    is_marked_.resize(cells_.size());
}

int Enrichment::index_of(const Vec3p& cell) const {
    const Vec3p local = cell - low_;
    return int(local[0]) + step_[1] * int(local[1]) + step_[2] * int(local[2]);
}

void Enrichment::mark_cells(const Lattice& lattice) {
    for (const int p : marking_) {
        const int region = lattice.region[p];
        const bool is_boundary = is_boundary_[p];
        const Vec3p& centre = centres_[p];
        Cell& own = cells_[index_of(floor_of(centre))];
        meet(own.region, region);
        own.boundary |= is_boundary;
        const Vec3p lowest = floor_of(centre - margin * to_all),
                    extent = floor_of(centre + margin * to_all) - lowest;
        const int first = index_of(lowest);
        for (int z = 0; z <= int(extent[2]); ++z)
            for (int y = 0; y <= int(extent[1]); ++y)
                for (int x = 0; x <= int(extent[0]); ++x) {
                    const int index = first + x + step_[1] * y + step_[2] * z;
                    if (!is_marked_[index])
                        marked_.push_back(index);
                    is_marked_[index] = true;
                    Cell& near = cells_[index];
                    meet(near.near_region, region);
                    near.near_boundary |= is_boundary;
                }
    }
}

}  // namespace sim
