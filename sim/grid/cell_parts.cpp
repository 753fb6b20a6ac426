#include "sim/grid/cell_parts.h"

#include "assets/base/disjoint_sets.h"
#include "sim/base/cell_box.h"
#include "sim/base/floor.h"

#include <algorithm>
#include <tuple>

namespace sim {

namespace {

using assets::DisjointSets;
using Cell = std::array<int, 3>;
using Domains = std::vector<std::array<int, 8>>;

std::vector<Cell> cells_of(const Field& corners,
                           const CornerMap::BodyRange& body,
                           double shift) {
    const Vec3p least = Vec3p{} + shift;
    const double inverse_size = 1 / body.cell_size;
    Vec3p low = floor_of(corners[body.begin] * inverse_size - least), high = low, sum{};
    std::vector<Cell> cells;
    for (int c = body.begin; c < body.end; ++c) {
        const Vec3p cell = floor_of(corners[c] * inverse_size - least);
        low = cell < low ? cell : low;
        high = cell > high ? cell : high;
        sum += cell;
        check_spread(high - low + 1.0, sum);
        cells.push_back({int(cell[0]), int(cell[1]), int(cell[2])});
    }
    return cells;
}

DisjointSets connect_within(const std::vector<Cell>& cells, const Domains& domains) {
    DisjointSets sets(static_cast<int>(cells.size()));
    for (const std::array<int, 8>& corners : domains)
        for (int a = 1; a < 8; ++a)
            for (int b = 0; b < a; ++b)
                if (cells[corners[a]] == cells[corners[b]]) {
                    sets.join(corners[a], corners[b]);
                    break;  // what is in the same cell with b is so already
                }
    return sets;
}

void number_parts(const std::vector<Cell>& cells, DisjointSets& sets, CellParts& result) {
    const int n = static_cast<int>(cells.size());
    std::vector<int> first;  // corner of each part
    for (int c = 0; c < n; ++c)
        if (sets.root(c) == c)
            first.push_back(c);
    std::sort(first.begin(), first.end(), [&](int a, int b) {
        const Cell &u = cells[a], &v = cells[b];
        return std::array{u[2], u[1], u[0], a} < std::array{v[2], v[1], v[0], b};
    });
    result.part_of_corner.resize(n);
    for (const int c : first) {
        result.part_of_corner[c] = static_cast<int>(result.lowest.size());
        result.lowest.push_back(cells[c]);
    }
    for (int c = 0; c < n; ++c)
        result.part_of_corner[c] = result.part_of_corner[sets.root(c)];
}

/// For each part those after it that a domain reaches as well.
std::vector<std::vector<int>> neighbours(const CellParts& parts, const Domains& domains) {
    std::vector<std::vector<int>> result(parts.lowest.size());
    for (const std::array<int, 8>& corners : domains)
        for (int a = 0; a < 8; ++a)
            for (int b = 0; b < 8; ++b) {
                const int p = parts.part_of_corner[corners[a]],
                          q = parts.part_of_corner[corners[b]];
                if (p < q
                    && std::find(result[p].begin(), result[p].end(), q) == result[p].end())
                    result[p].push_back(q);
            }
    return result;
}

/// A node of a part's stencil, and its place.
struct Entry {
    std::array<int, 3> place;
    int part = 0, index = 0;  // of the node in the stencil

    bool operator<(const Entry& other) const {
        return std::tie(place, part) < std::tie(other.place, other.part);
    }
};

std::vector<Entry> entries_by_place(const CellParts& parts, int n) {
    std::vector<Entry> entries;
    for (int p = 0; p < static_cast<int>(parts.lowest.size()); ++p)
        for (int a = 0; a < n * n * n; ++a) {
            const auto& [x, y, z] = parts.lowest[p];
            entries.push_back({{z + a / (n * n), y + a / n % n, x + a % n}, p, a});
        }
    std::sort(entries.begin(), entries.end());
    return entries;
}

/// Numbers the copies of the node whose entries are [begin, end).
void number_copies(const Entry* begin,
                   const Entry* end,
                   const std::vector<std::vector<int>>& neighbours,
                   int per_part,
                   CellParts& result) {
    const int n = static_cast<int>(end - begin);
    DisjointSets sets(n);
    for (int k = 0; k < n; ++k)
        for (const int q : neighbours[begin[k].part])
            for (int l = k + 1; l < n; ++l)
                if (begin[l].part == q)
                    sets.join(k, l);
    std::vector<int> number(n);
    for (int k = 0; k < n; ++k) {
        number[k] = sets.root(k) == k ? result.n_copies++ : number[sets.root(k)];
        result.copies[begin[k].part * per_part + begin[k].index] = number[k];
    }
}

}  // namespace

CellParts cut_cells(const Field& corners,
                    const CornerMap::BodyRange& body,
                    int n,
                    double shift) {
    CellParts result;
    const std::vector<Cell> cells = cells_of(corners, body, shift);
    DisjointSets sets = connect_within(cells, *body.domains);
    number_parts(cells, sets, result);

    const int per_part = n * n * n;
    result.copies.resize(result.lowest.size() * per_part);
    const std::vector<std::vector<int>> connected = neighbours(result, *body.domains);
    const std::vector<Entry> entries = entries_by_place(result, n);
    for (const Entry *begin = entries.data(), *last = begin + entries.size(); begin < last;) {
        const Entry* end = std::find_if(
            begin, last, [&](const Entry& entry) { return entry.place != begin->place; });
        number_copies(begin, end, connected, per_part, result);
        begin = end;
    }
    return result;
}

}  // namespace sim
