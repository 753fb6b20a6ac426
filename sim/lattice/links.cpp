#include "sim/lattice/links.h"

#include <algorithm>
#include <numeric>

namespace sim {

namespace {

using Cell = std::array<int, 3>;

int axes_apart(const Cell& a, const Cell& b) {
    return (a[0] != b[0]) + (a[1] != b[1]) + (a[2] != b[2]);
}

bool bit(const FaceMask& mask, int axis, const Cell& at) {
    return mask[at[(axis + 2) % 3]] >> at[(axis + 1) % 3] & 1;
}

/// The domains around each corner, ascending.
struct DomainsOfCorners {
    explicit DomainsOfCorners(const Lattice& lattice) : begin(lattice.corner_cell.size() + 1) {
        for (const auto& corners : lattice.corners)
            for (const int c : corners)
                ++begin[c + 1];
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        domains.resize(begin.back());
        std::vector<int> next(begin.begin(), begin.end() - 1);
        for (int p = 0; p < lattice.n_domains(); ++p)
            for (const int c : lattice.corners[p])
                domains[next[c]++] = p;
    }

    std::vector<int> begin, domains;
};

/// Divides the domains around one corner into those that hang together: for each its class, numbered by the lowest.
/// Returns the number of classes.
int classes_around(const int* domains,
                   int n,
                   const Lattice& lattice,
                   Links& links,
                   std::vector<int>& class_of) {
    class_of.resize(n);
    std::iota(class_of.begin(), class_of.end(), 0);
    // Chains through faces decide nearly always; edges and corners are asked where they do not.
    for (int apart = 1; apart <= 3; ++apart) {
        for (int i = 0; i < n; ++i)
            for (int j = i + 1; j < n; ++j)
                if (class_of[i] != class_of[j]
                    && axes_apart(lattice.cell[domains[i]], lattice.cell[domains[j]]) == apart
                    && links.meet(domains[i], domains[j])) {
                    const auto [low, high] = std::minmax({class_of[i], class_of[j]});
                    std::replace(class_of.begin(), class_of.end(), high, low);
                }
        if (std::all_of(class_of.begin(), class_of.end(), [](int k) { return k == 0; }))
            return 1;
    }
    int n_classes = 0;
    for (int i = 0; i < n; ++i)
        class_of[i] = class_of[i] == i ? n_classes++ : class_of[class_of[i]];
    return n_classes;
}

}  // namespace

bool Links::meet(int p, int q) {
    const FilledCube &one = cubes_[p], &other = cubes_[q];
    const Cell &a = one.cell, &b = other.cell;
    const int apart = axes_apart(a, b);
    if (apart == 0)
        return false;
    if (one.is_whole() && other.is_whole())
        return true;
    int axis = 0;  // the first along which they differ; what they share lies on these faces
    while (a[axis] == b[axis])
        ++axis;
    const int face = 2 * axis + (b[axis] > a[axis]), opposite = face ^ 1;
    if (apart == 1 && !one.shape && !other.shape
        && (one.faces[face] & other.faces[opposite]) != 0)
        return true;
    const FaceMask &mask_one = mask(p, face), &mask_other = mask(q, opposite);
    // Fine cells on both sides of what they share: along axes that differ at the end, along others at the same place.
    Cell at_one{}, at_other{}, n{};
    for (int k = 0; k < 3; ++k) {
        n[k] = a[k] == b[k] ? fine_per_edge : 1;
        at_one[k] = b[k] > a[k] ? fine_per_edge - 1 : 0;
        at_other[k] = b[k] < a[k] ? fine_per_edge - 1 : 0;
    }
    for (int i = 0; i < n[0]; ++i)
        for (int j = 0; j < n[1]; ++j)
            for (int k = 0; k < n[2]; ++k)
                if (bit(mask_one, axis, {at_one[0] + i, at_one[1] + j, at_one[2] + k})
                    && bit(
                        mask_other, axis, {at_other[0] + i, at_other[1] + j, at_other[2] + k}))
                    return true;
    return false;
}

const FaceMask& Links::mask(int p, int face) {
    if (cubes_[p].shape)
        return cubes_[p].shape->faces[face];
    const auto [at, is_new] = masks_.try_emplace({p, face});
    if (is_new)
        at->second = face_mask(grid_, solid_, cubes_[p].cell, face);
    return at->second;
}

void separate_corners(Links& links,
                      const CubeGrid& grid,
                      const assets::Solid& solid,
                      const std::vector<FilledCube>& cubes,
                      Lattice& lattice) {
    const DomainsOfCorners around(lattice);
    std::vector<std::array<int, 3>> corner_cell;
    std::vector<char> is_separate(lattice.n_domains(), false);
    std::vector<int> class_of;
    for (std::size_t c = 0; c < lattice.corner_cell.size(); ++c) {
        const int* domains = &around.domains[around.begin[c]];
        const int n = around.begin[c + 1] - around.begin[c];
        const int n_classes = classes_around(domains, n, lattice, links, class_of);
        const int first = static_cast<int>(corner_cell.size());
        for (int k = 0; k < n_classes; ++k)
            corner_cell.push_back(lattice.corner_cell[c]);
        for (int i = 0; i < n; ++i) {
            is_separate[domains[i]] |= n_classes > 1;
            for (int a = 0; a < 8; ++a) {
                const auto& [x, y, z] = lattice.cell[domains[i]];
                if (Cell{x + (a & 1), y + (a >> 1 & 1), z + (a >> 2)} == lattice.corner_cell[c])
                    lattice.corners[domains[i]][a] = first + class_of[i];
            }
        }
    }
    lattice.corner_cell = std::move(corner_cell);

    lattice.part.assign(lattice.n_domains(), -1);
    for (int p = 0; p < lattice.n_domains(); ++p)
        if (is_separate[p]) {
            lattice.part[p] = static_cast<int>(lattice.parts.size());
            lattice.parts.push_back(cubes[p].shape ? cubes[p].shape->blocks
                                                   : part_blocks(grid, solid, cubes[p].cell));
        }
}

}  // namespace sim
