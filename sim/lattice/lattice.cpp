#include "sim/lattice/lattice.h"

#include "assets/base/error.h"
#include "sim/lattice/links.h"
#include "sim/lattice/region_report.h"
#include "sim/lattice/slivers.h"
#include "sim/lattice/voxels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>

namespace sim {

namespace {

/// What fills each domain.
void set_domains(const std::vector<FilledCube>& cubes,
                 const std::vector<Region>& regions,
                 Lattice& lattice) {
    const std::size_t n = cubes.size();
    lattice.cell.resize(n);
    lattice.fill.resize(n);
    lattice.region.resize(n);
    lattice.mu.assign(n, 0);
    lattice.lambda.assign(n, 0);
    lattice.density.assign(n, 0);
    for (std::size_t p = 0; p < n; ++p) {
        const FilledCube& cube = cubes[p];
        lattice.cell[p] = cube.cell;
        lattice.fill[p] = cube.filled / samples_per_cube;
        double most = 0;
        for (const auto& [r, count] : cube.samples) {
            const Region& region = regions[r];
            const double share = count / cube.filled;
            lattice.mu[p] += share * lame_mu(region.young_modulus, region.poisson_ratio);
            lattice.lambda[p] +=
                share * lame_lambda(region.young_modulus, region.poisson_ratio);
            lattice.density[p] += share * region.density;
            if (count > most) {
                most = count;
                lattice.region[p] = r;
            }
        }
    }
}

/// Numbers the corners of all domains by z, then y, then x. Two slabs of domains meet at each plane of corners.
void set_corners(const std::array<int, 3>& n, Lattice& lattice) {
    const int n_domains = lattice.n_domains();
    lattice.corners.resize(n_domains);
    std::vector<int> slab_begin(n[2] + 2, n_domains);  // first domain with cell z >= k
    for (int p = n_domains - 1; p >= 0; --p)
        slab_begin[lattice.cell[p][2]] = p;
    for (int k = n[2]; k > 0; --k)
        slab_begin[k - 1] = std::min(slab_begin[k - 1], slab_begin[k]);

    const int width = n[0] + 1;
    std::vector<int> plane;  // corner number by (x, y): -1 unused
    for (int k = 0; k <= n[2]; ++k) {
        plane.assign(static_cast<std::size_t>(width) * (n[1] + 1), -1);
        const auto for_corners_in_plane = [&](auto&& visit) {
            for (int p = slab_begin[std::max(k - 1, 0)]; p < slab_begin[k + 1]; ++p)
                for (int a = 0; a < 8; ++a) {
                    const auto& [x, y, z] = lattice.cell[p];
                    if (z + (a >> 2 & 1) == k)
                        visit(p,
                              a,
                              plane[static_cast<std::size_t>(y + (a >> 1 & 1)) * width + x
                                    + (a & 1)]);
                }
        };
        for_corners_in_plane([](int, int, int& number) { number = 0; });
        for (std::size_t i = 0; i < plane.size(); ++i)
            if (plane[i] == 0) {
                plane[i] = static_cast<int>(lattice.corner_cell.size());
                lattice.corner_cell.push_back(
                    {static_cast<int>(i % width), static_cast<int>(i / width), k});
            }
        for_corners_in_plane([&](int p, int a, int number) { lattice.corners[p][a] = number; });
    }
}

/// Whether several corners lie at the place of this one.
bool lies_with_another(const Lattice& lattice, std::size_t c) {
    const auto& cells = lattice.corner_cell;
    return (c > 0 && cells[c - 1] == cells[c])
           || (c + 1 < cells.size() && cells[c + 1] == cells[c]);
}

/// Whether a corner has domains in all eight directions.
std::vector<char> inner_corners(const Lattice& lattice) {
    std::vector<unsigned> directions(lattice.corner_cell.size(), 0);
    for (const auto& corners : lattice.corners)
        for (int a = 0; a < 8; ++a)
            directions[corners[a]] |= 1u << a;
    std::vector<char> is_inner;
    for (const unsigned seen : directions)
        is_inner.push_back(seen == 0xff);
    return is_inner;
}

void set_corner_shares(const CubeGrid& grid, const assets::Solid& solid, Lattice& lattice) {
    const std::size_t n = lattice.corner_cell.size();
    lattice.corner_rest.resize(n);
    lattice.corner_outside.resize(n);
    lattice.corner_mass.assign(n, 0);
    lattice.corner_volume.assign(n, 0);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t c) {
        const auto& [x, y, z] = lattice.corner_cell[c];
        lattice.corner_rest[c] = grid.point(x, y, z);
        lattice.corner_outside[c] = solid.signed_distance(lattice.corner_rest[c]);
    });
    const std::vector<char> is_inner = inner_corners(lattice);
    for (std::size_t c = 0; c < n; ++c)
        if (is_inner[c])
            lattice.corner_outside[c] = std::max(0.0, lattice.corner_outside[c]);
    // Of several corners at one place each is outside its own part.
    std::vector<double> squared(n, std::numeric_limits<double>::infinity());
    for (int p = 0; p < lattice.n_domains(); ++p)
        if (lattice.part[p] >= 0)
            for (const int c : lattice.corners[p]) {
                const auto& [x, y, z] = lattice.corner_cell[c];
                squared[c] = std::min(squared[c], squared_distance(lattice, p, Vec3(x, y, z)));
            }
    for (std::size_t c = 0; c < n; ++c)
        if (lies_with_another(lattice, c))
            lattice.corner_outside[c] =
                std::max(lattice.corner_outside[c], lattice.edge * std::sqrt(squared[c]));
    for (int p = 0; p < lattice.n_domains(); ++p)
        for (const int c : lattice.corners[p]) {
            lattice.corner_volume[c] += lattice.domain_volume(p) / 8;
            lattice.corner_mass[c] += lattice.domain_volume(p) * lattice.density[p] / 8;
        }
}

void set_centres(const std::vector<FilledCube>& cubes,
                 const CubeGrid& grid,
                 const assets::Solid& solid,
                 Lattice& lattice) {
    lattice.filled_centre.resize(cubes.size());
    lattice.centre_outside.resize(cubes.size());
    tbb::parallel_for(std::size_t{0}, cubes.size(), [&](std::size_t p) {
        const FilledCube& cube = cubes[p];
        const Vec3 middle = cube.moment / (cube.filled * samples_per_edge);
        const Vec3 X = grid.point(
            cube.cell[0] + middle.x(), cube.cell[1] + middle.y(), cube.cell[2] + middle.z());
        lattice.filled_centre[p] = X;
        lattice.centre_outside[p] = solid.signed_distance(X);
    });
}

}  // namespace

Lattice make_lattice(const Body& body, std::vector<std::string>* repairs, Slivers slivers) {
    assets::check(body.domain_size > 0, "the domain size is positive");
    LevelMaker maker(body);
    const assets::Solid& solid = maker.solid();
    const RegionLayers regions(body, maker);
    const CubeGrid grid = place_grid(solid, body);
    std::vector<FilledCube> cubes = fill_cubes(grid, solid, regions);
    if (cubes.empty())
        throw assets::Error(
            assets::ErrorKind::Input,
            fmt::format("body \"{}\" fills no domain of {:g} m: use a smaller domain_size",
                        body.name,
                        body.domain_size),
            "body." + body.name + ".domain_size");
    const RegionTally tally = tally_regions(cubes, body.regions.size());
    require_each_region(body, tally, cubes, grid, solid, regions);
    if (slivers == Slivers::Joined)
        join_slivers(cubes);

    Lattice lattice;
    lattice.edge = grid.edge;
    lattice.origin = grid.origin;
    set_domains(cubes, body.regions, lattice);
    set_centres(cubes, grid, solid, lattice);
    set_corners(grid.n, lattice);
    Links links(grid, solid, cubes);
    separate_corners(links, grid, solid, cubes, lattice);
    set_corner_shares(grid, solid, lattice);
    const double sample_volume = grid.edge * grid.edge * grid.edge / samples_per_cube;
    for (std::size_t r = 0; r < body.regions.size(); ++r) {
        lattice.region_volume.push_back(tally.samples[r] * sample_volume);
        lattice.region_mass.push_back(lattice.region_volume[r] * body.regions[r].density);
    }
    if (repairs) {
        repairs->insert(repairs->end(), maker.repairs().begin(), maker.repairs().end());
        note_thin_regions(body, tally, *repairs);
    }
    return lattice;
}

double squared_distance(const Lattice& lattice, int domain, const Vec3& point) {
    const auto& cell = lattice.cell[domain];
    const Vec3 xi = point - Vec3(cell[0], cell[1], cell[2]);
    if (lattice.part[domain] >= 0)
        return lattice.parts[lattice.part[domain]].squared_distance(xi);
    return (-xi).cwiseMax(xi - Vec3::Ones()).cwiseMax(0.0).squaredNorm();
}

namespace {

/// Takes out of the selected corners those that lie with others at one place and have no material in the selected part,
/// while another of them has.
void keep_own_parts(const Lattice& lattice, const Level& level, std::vector<int>& selected) {
    std::map<int, bool> has_material;  // of selected corners that lie with others
    for (const int c : selected)
        if (lies_with_another(lattice, c))
            has_material[c] = false;
    if (has_material.empty())
        return;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        if (lattice.part[p] < 0)
            continue;
        bool has = false;
        const auto& [x, y, z] = lattice.cell[p];
        lattice.parts[lattice.part[p]].for_each([&](const Vec3& middle) {
            has = has
                  || level(lattice.origin + lattice.edge * (Vec3(x, y, z) + middle))
                         <= selection_tolerance * lattice.edge;
        });
        for (const int c : lattice.corners[p])
            if (const auto at = has_material.find(c); at != has_material.end())
                at->second |= has;
    }
    std::map<std::array<int, 3>, bool> any_at;
    for (const auto& [c, has] : has_material)
        any_at[lattice.corner_cell[c]] |= has;
    selected.erase(std::remove_if(selected.begin(),
                                  selected.end(),
                                  [&](int c) {
                                      const auto at = has_material.find(c);
                                      return at != has_material.end() && !at->second
                                             && any_at[lattice.corner_cell[c]];
                                  }),
                   selected.end());
}

}  // namespace

std::vector<int> select_corners(const Lattice& lattice,
                                const Body& body,
                                const Selector& select) {
    LevelMaker maker(body);
    const Level level = maker.make(select);
    std::vector<int> selected;
    for (int c = 0; c < lattice.n_corners(); ++c)
        if (level(lattice.corner_rest[c]) <= selection_tolerance * lattice.edge)
            selected.push_back(c);
    keep_own_parts(lattice, level, selected);
    if (!selected.empty())
        return selected;
    Vec3 min = lattice.corner_rest.front(), max = min;
    for (const Vec3& X : lattice.corner_rest) {
        min = min.cwiseMin(X);
        max = max.cwiseMax(X);
    }
    throw assets::Error(assets::ErrorKind::Input,
                        fmt::format("selects no corner of body \"{}\", whose corners span "
                                    "[{:g}, {:g}, {:g}] to [{:g}, {:g}, {:g}] m",
                                    body.name,
                                    min.x(),
                                    min.y(),
                                    min.z(),
                                    max.x(),
                                    max.y(),
                                    max.z()),
                        select.key);
}

double lame_lambda(double young_modulus, double poisson_ratio) {
    return young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
}

double lame_mu(double young_modulus, double poisson_ratio) {
    return young_modulus / (2 * (1 + poisson_ratio));
}

}  // namespace sim
