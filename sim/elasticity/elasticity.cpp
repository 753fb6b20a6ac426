#include "sim/elasticity/elasticity.h"

#include "sim/base/parallel.h"
#include "sim/elasticity/brick_layout.h"

#include <algorithm>
#include <map>

namespace sim {

namespace {

// Cells per brick along x, y, z: long rows for full batches, small enough for the second-level cache.
constexpr std::array<int, 3> largest_brick = {32, 8, 8};

/// Hourglass stiffness k of the bilinear modes, E_hg = k/2 Σ h²: eps mu V / (12 s²) with eps = (1+nu)/2.   [N/m]
double hourglass_stiffness(const Lattice& lattice, int p) {
    const double mu = lattice.mu[p], lambda = lattice.lambda[p];
    const double nu = lambda / (2 * (lambda + mu));
    return (1 + nu) / 2 * mu * lattice.domain_volume(p) / (12 * lattice.edge * lattice.edge);
}

/// Divides the domains of a box of cells so that in each layer a place has one corner at most: a brick has one place for
/// it. One layer is enough where the body has no parts that only share cells.
std::vector<std::vector<int>> layers_of(const Lattice& lattice,
                                        const std::vector<int>& domains) {
    struct Layer {
        std::vector<int> domains;
        std::map<std::array<int, 3>, int> separate;  // corner at a place that has several
    };

    std::vector<Layer> layers(1);
    for (const int p : domains) {
        if (lattice.part[p] < 0) {
            layers[0].domains.push_back(p);
            continue;
        }
        for (std::size_t k = 0;; ++k) {
            if (k == layers.size())
                layers.emplace_back();
            Layer& layer = layers[k];
            const auto fits = [&](int c) {
                const auto at = layer.separate.find(lattice.corner_cell[c]);
                return at == layer.separate.end() || at->second == c;
            };
            const auto& corners = lattice.corners[p];
            if (!std::all_of(corners.begin(), corners.end(), fits))
                continue;
            for (const int c : corners)
                layer.separate[lattice.corner_cell[c]] = c;
            layer.domains.push_back(p);
            break;
        }
    }
    std::vector<std::vector<int>> result;
    for (Layer& layer : layers)
        result.push_back(std::move(layer.domains));
    return result;
}

/// Asks for the value of each local corner some batches before its turn: rows of a brick are too short for the processor to
/// fetch ahead by itself. Two values share a line of the cache.
template <bool writes>
[[gnu::always_inline]] inline void fetch_ahead(const Vec3p* values,
                                               const int* corner,
                                               int l,
                                               int n) {
    constexpr int ahead = 16 * lane_count;
    if (l + ahead >= n)
        return;
    for (int k = l + ahead; k < l + ahead + lane_count; k += 2)
        if (corner[k] >= 0)
            __builtin_prefetch(&values[corner[k]], writes);
}

}  // namespace

Elasticity::Elasticity(const Lattice& lattice, const Body& body) : edge_(lattice.edge) {
    // Equal bricks over the body's box of cells, those without a domain left out.
    const CellRange range = cell_range(lattice);
    std::array<int, 3> size;
    for (int k = 0; k < 3; ++k) {
        const int n = range.high[k] - range.low[k] + 1;
        const int n_bricks = (n + largest_brick[k] - 1) / largest_brick[k];
        size[k] = (n + n_bricks - 1) / n_bricks;
    }
    // Domains, keyed z, y, x: lattice order.
    std::map<std::array<int, 3>, std::vector<std::vector<int>>> layers_of_brick;
    std::size_t n_layers = 0;
    {
        std::map<std::array<int, 3>, std::vector<int>> domains_of_brick;
        for (int p = 0; p < lattice.n_domains(); ++p) {
            std::array<int, 3> key;
            for (int k = 0; k < 3; ++k)
                key[2 - k] = (lattice.cell[p][k] - range.low[k]) / size[k];
            domains_of_brick[key].push_back(p);
        }
        for (const auto& [key, domains] : domains_of_brick) {
            layers_of_brick[key] = layers_of(lattice, domains);
            n_layers = std::max(n_layers, layers_of_brick[key].size());
        }
    }
    // Bricks of one colour share no corner: neighbours differ in the parity of one coordinate at least, layers of one
    // box of cells are of different colours.
    for (std::size_t layer = 0; layer < n_layers; ++layer)
        for (int color = 0; color < 8; ++color) {
            color_start_.push_back(static_cast<int>(bricks_.size()));
            for (const auto& [key, layers] : layers_of_brick) {
                if (layer >= layers.size()
                    || (key[0] & 1) + 2 * (key[1] & 1) + 4 * (key[2] & 1) != color)
                    continue;
                fill_brick(lattice, body, layers[layer]);
            }
        }
    color_start_.push_back(static_cast<int>(bricks_.size()));

    add_wave_compliances(lattice);

    std::vector<char> met(lattice.n_corners(), 0);
    adds_.assign(corner_of_local_.size(), 0);
    for (std::size_t l = 0; l < corner_of_local_.size(); ++l)
        if (const int c = corner_of_local_[l]; c >= 0) {
            adds_[l] = met[c];
            met[c] = 1;
        }
}

void Elasticity::fill_brick(const Lattice& lattice,
                            const Body& body,
                            const std::vector<int>& domains) {
    Brick brick;
    const BrickLayout layout = best_brick_layout(lattice, domains);
    const int n_places = static_cast<int>(layout.corner.size());
    // Whole batches, and two after the last.
    brick.n_local = (n_places / lane_count + 4) * lane_count;
    brick.first_local = static_cast<int>(corner_of_local_.size());
    corner_of_local_.insert(corner_of_local_.end(), layout.corner.begin(), layout.corner.end());
    corner_of_local_.resize(brick.first_local + brick.n_local, -1);
    for (const Batch& batch : layout.batches)
        add_batch(lattice, body, batch, brick);
    brick.stiffness.assign(45 * brick.batch.size(), FloatLanes{});
    bricks_.push_back(std::move(brick));
}

void Elasticity::add_batch(const Lattice& lattice,
                           const Body& body,
                           const Batch& batch,
                           Brick& brick) {
    const Lanes zero{};
    alignas(64) Lanes volume = zero, mu = zero, lambda = zero, law = zero - 1.0,
                      hourglass = zero;
    unsigned laws = 0;
    for (int l = 0; l < lane_count; ++l) {
        const int p = batch.domain[l];
        if (p < 0)
            continue;
        const Model model = body.regions[lattice.region[p]].model;
        laws |= 1u << static_cast<int>(model);
        law[l] = static_cast<double>(model);
        volume[l] = lattice.domain_volume(p);
        mu[l] = lattice.mu[p];
        lambda[l] = lattice.lambda[p];
        hourglass[l] = hourglass_stiffness(lattice, p);
    }
    brick.batch.push_back(batch);
    brick.laws.push_back(laws);
    brick.volume.push_back(volume);
    brick.mu.push_back(mu);
    brick.lambda.push_back(lambda);
    brick.law.push_back(law);
    brick.hourglass.push_back(hourglass);
    brick.weight.push_back(volume * mu);
}

void Elasticity::add_wave_compliances(const Lattice& lattice) {
    const std::vector<double> compliances = wave_compliances(lattice);
    for (Brick& brick : bricks_)
        for (const Batch& batch : brick.batch) {
            alignas(64) Lanes compliance{};
            for (int l = 0; l < lane_count; ++l)
                if (batch.domain[l] >= 0)
                    compliance[l] = compliances[batch.domain[l]];
            brick.wave_compliance.push_back(compliance);
        }
}

BrickFields Elasticity::Scratch::fields(int n_local) {
    BrickFields fields;
    for (int i = 0; i < 3; ++i) {
        in[i].resize(n_local);
        out[i].resize(n_local);
        fields.in[i] = in[i].data();
        fields.out[i] = out[i].data();
    }
    return fields;
}

void Elasticity::load(const Brick& brick, const Vec3p* values, Scratch& scratch) const {
    const Vec3p none{};
    const int* corner = &corner_of_local_[brick.first_local];
    for (int l = 0; l < brick.n_local; l += lane_count) {
        Vec3p row[lane_count];
        fetch_ahead<false>(values, corner, l, brick.n_local);
        for (int k = 0; k < lane_count; ++k)
            row[k] = corner[l + k] >= 0 ? values[corner[l + k]] : none;
        transpose(row);
        for (int i = 0; i < 3; ++i)
            store_lanes(row[i], &scratch.in[i][l]);
    }
}

void Elasticity::store(const Brick& brick, const Scratch& scratch, Vec3p* values) const {
    const int* corner = &corner_of_local_[brick.first_local];
    const char* adds = &adds_[brick.first_local];
    for (int l = 0; l < brick.n_local; l += lane_count) {
        Vec3p row[lane_count] = {};
        fetch_ahead<true>(values, corner, l, brick.n_local);
        for (int i = 0; i < 3; ++i)
            row[i] = load_lanes(&scratch.out[i][l]);
        transpose(row);
        for (int k = 0; k < lane_count; ++k)
            if (const int c = corner[l + k]; c >= 0)
                values[c] = adds[l + k] ? values[c] + row[k] : row[k];
    }
}

template <class Kernel>
double Elasticity::for_bricks(const Vec3p* in, Vec3p* out, const Kernel& kernel) {
    double sum = 0;
    for (std::size_t color = 0; color + 1 < color_start_.size(); ++color) {
        const int first = color_start_[color];
        sum += sum_chunks(color_start_[color + 1] - first, 1, [&](int begin, int /*end*/) {
            thread_local Scratch scratch;
            Brick& brick = bricks_[first + begin];
            const BrickFields fields = scratch.fields(brick.n_local);
            if (in != nullptr)
                load(brick, in, scratch);
            if (out != nullptr)
                for (auto& array : scratch.out)
                    std::fill(array.begin(), array.end(), 0.0);
            const double value = kernel(brick, fields);
            if (out != nullptr)
                store(brick, scratch, out);
            return value;
        });
    }
    return sum;
}

double Elasticity::energy_and_gradient(const Vec3p* x, Vec3p* gradient) {
    return for_bricks(x, gradient, [&](const Brick& brick, const BrickFields& fields) {
        return add_brick_gradient(brick, edge_, fields, takes_pairs);
    });
}

void Elasticity::linearize(const Vec3p* x, bool project) {
    for_bricks(x, nullptr, [&](Brick& brick, const BrickFields& fields) {
        linearize_brick(brick, edge_, fields);
        if (project)
            project_brick(brick, edge_, fields);
        return 0.0;
    });
}

void Elasticity::product(const Vec3p* u, Vec3p* product) {
    for_bricks(u, product, [&](const Brick& brick, const BrickFields& fields) {
        add_brick_product(brick, edge_, fields);
        return 0.0;
    });
}

void Elasticity::diagonal(Vec3p* diagonal) {
    for_bricks(nullptr, diagonal, [&](const Brick& brick, const BrickFields& fields) {
        add_brick_diagonal(brick, edge_, fields);
        return 0.0;
    });
}

double Elasticity::stiffening(const Vec3p* x) const {
    std::vector<double> of_brick(bricks_.size());
    for_chunks(static_cast<int>(bricks_.size()), 1, [&](int first, int last) {
        thread_local Scratch scratch;
        for (int k = first; k < last; ++k) {
            const BrickFields fields = scratch.fields(bricks_[k].n_local);
            load(bricks_[k], x, scratch);
            of_brick[k] = brick_stiffening(bricks_[k], edge_, fields);
        }
    });
    return *std::max_element(of_brick.begin(), of_brick.end());
}

Elasticity::SmallestJ Elasticity::smallest_J(const Vec3p* x) const {
    SmallestJ smallest{2e300, -1};
    Scratch scratch;
    std::vector<Lanes> J;
    for (const Brick& brick : bricks_) {
        const BrickFields fields = scratch.fields(brick.n_local);
        load(brick, x, scratch);
        J.resize(brick.batch.size());
        find_J(brick, edge_, fields, J.data());
        for (std::size_t b = 0; b < brick.batch.size(); ++b)
            for (int l = 0; l < lane_count; ++l)
                if (const int p = brick.batch[b].domain[l];
                    p >= 0
                    && (is_worse(J[b][l], smallest.J)
                        || (J[b][l] == smallest.J && p < smallest.domain)))
                    smallest = {J[b][l], p};
    }
    return smallest;
}

}  // namespace sim
