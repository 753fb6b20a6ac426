#include "sim/enrichment/enrichment.h"

#include "assets/base/error.h"
#include "sim/enrichment/thin_domains.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <map>

namespace sim {

namespace {

constexpr double most_cells = 1 << 28;
constexpr double margin = 0.25;    // in cells
constexpr double least_cells = 3;  // across a part that its nodes can bend
constexpr int none = -1, several = -2;

/// Bounds of stretch under which a domain is enriched, and above which it is no longer.
struct StretchBounds {
    double smallest = 0, ratio = 0;
};

constexpr StretchBounds enter{0.5, 0.35}, leave{0.6, 0.45};

Vec3p floor_of(const Vec3p& v) {
    return Vec3p{std::floor(v[0]), std::floor(v[1]), std::floor(v[2]), 0};
}

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
    std::map<std::array<int, 3>, int>
        first_at;  // of the domains of a cell, which follow each other
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
}

void Enrichment::update(const Lattice& lattice, const Vec3p* corners, char* free) {
    const bool by_cells = criteria_.interface || criteria_.mixed_cell;
    if (!by_cells && !criteria_.thin && !criteria_.strain)
        return;
    if (by_cells)
        mark_cells(lattice, corners);
    for (int p = 0; p < lattice.n_domains(); ++p) {
        const bool was = enriched_[p];
        bool is = is_thin_[p];
        if (by_cells) {
            const Cell& cell = cell_at(centres_[p]);
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
}

void Enrichment::mark_cells(const Lattice& lattice, const Vec3p* corners) {
    const int n = lattice.n_domains();
    centres_.resize(n);
    Vec3p low{}, high{};
    for (int p = 0; p < n; ++p) {
        Vec3p sum{};
        for (const int c : lattice.corners[p])
            sum += corners[c];
        centres_[p] = sum * (0.125 / cell_size_);
        const Vec3p cell = floor_of(centres_[p]);
        if (p == 0)
            low = high = cell;
        low = cell < low ? cell : low;
        high = cell > high ? cell : high;
    }
    low_ = low - Vec3p{1, 1, 1, 0};  // the margin may reach one cell further
    size_ = high - low + Vec3p{3, 3, 3, 0};
    if (!(size_[0] * size_[1] * size_[2] < most_cells))
        throw assets::Error(
            assets::ErrorKind::Diverged,
            "a body spreads over more background cells than can be held; it has flown apart");
    cells_.assign(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]), Cell{});
    for (int p = 0; p < n; ++p)
        if (is_boundary_[p] || criteria_.mixed_cell)
            mark(centres_[p], lattice.region[p], is_boundary_[p]);
}

Enrichment::Cell& Enrichment::cell_at(const Vec3p& centre) {
    const Vec3p local = floor_of(centre) - low_;
    return cells_[static_cast<std::size_t>(local[0]
                                           + size_[0] * (local[1] + size_[1] * local[2]))];
}

void Enrichment::mark(const Vec3p& centre, int region, bool is_boundary) {
    Cell& own = cell_at(centre);
    meet(own.region, region);
    own.boundary |= is_boundary;
    const Vec3p first = floor_of(centre - margin), last = floor_of(centre + margin);
    for (double z = first[2]; z <= last[2]; ++z)
        for (double y = first[1]; y <= last[1]; ++y)
            for (double x = first[0]; x <= last[0]; ++x) {
                Cell& near = cell_at(Vec3p{x, y, z, 0});
                meet(near.near_region, region);
                near.near_boundary |= is_boundary;
            }
}

}  // namespace sim
