#include "sim/elasticity/elasticity.h"

#include "sim/base/parallel.h"

#include <algorithm>
#include <map>

namespace sim {

namespace {

// Cells per brick along x, y, z: long rows for full batches, small enough for the second-level cache.
constexpr std::array<int, 3> largest_brick = {32, 8, 8};
constexpr int corner_chunk = 8192;

struct Range {
    std::array<int, 3> low, high;  // inclusive
};

Range cell_range(const Lattice& lattice) {
    Range range{lattice.cell.front(), lattice.cell.front()};
    for (const auto& cell : lattice.cell)
        for (int k = 0; k < 3; ++k) {
            range.low[k] = std::min(range.low[k], cell[k]);
            range.high[k] = std::max(range.high[k], cell[k]);
        }
    return range;
}

/// Hourglass stiffness k of the bilinear modes, E_hg = k/2 Σ h²: eps mu V / (12 s²) with eps = (1+nu)/2.   [N/m]
double hourglass_stiffness(const Lattice& lattice, int p) {
    const double mu = lattice.mu[p], lambda = lattice.lambda[p];
    const double nu = lambda / (2 * (lambda + mu));
    return (1 + nu) / 2 * mu * lattice.domain_volume(p) / (12 * lattice.edge * lattice.edge);
}

}  // namespace

Elasticity::Elasticity(const Lattice& lattice, const Body& body) : edge_(lattice.edge) {
    // Equal bricks over the body's box of cells, those without a domain left out.
    const Range range = cell_range(lattice);
    std::array<int, 3> size;
    for (int k = 0; k < 3; ++k) {
        const int n = range.high[k] - range.low[k] + 1;
        const int n_bricks = (n + largest_brick[k] - 1) / largest_brick[k];
        size[k] = (n + n_bricks - 1) / n_bricks;
    }
    std::map<std::array<int, 3>, std::vector<int>>
        domains_of_brick;  // keyed z, y, x: lattice order
    for (int p = 0; p < lattice.n_domains(); ++p) {
        std::array<int, 3> key;
        for (int k = 0; k < 3; ++k)
            key[2 - k] = (lattice.cell[p][k] - range.low[k]) / size[k];
        domains_of_brick[key].push_back(p);
    }
    for (const auto& [key, domains] : domains_of_brick) {
        std::array<int, 3> low;
        for (int k = 0; k < 3; ++k)
            low[k] = range.low[k] + key[2 - k] * size[k];
        fill_brick(lattice, body, low, size, domains);
    }

    // Each corner's local copies.
    sources_start_.assign(lattice.n_corners() + 1, 0);
    for (const int c : corner_of_local_)
        if (c >= 0)
            ++sources_start_[c + 1];
    for (int c = 0; c < lattice.n_corners(); ++c)
        sources_start_[c + 1] += sources_start_[c];
    sources_.resize(sources_start_.back());
    std::vector<int> next(sources_start_.begin(), sources_start_.end() - 1);
    for (std::size_t l = 0; l < corner_of_local_.size(); ++l)
        if (corner_of_local_[l] >= 0)
            sources_[next[corner_of_local_[l]]++] = static_cast<int>(l);
    for (int i = 0; i < 3; ++i) {
        in_[i].assign(corner_of_local_.size(), 0.0);
        out_[i].assign(corner_of_local_.size(), 0.0);
        out_right_[i].assign(corner_of_local_.size(), 0.0);
    }
}

void Elasticity::fill_brick(const Lattice& lattice,
                            const Body& body,
                            const std::array<int, 3>& low,
                            const std::array<int, 3>& size,
                            const std::vector<int>& domains) {
    Brick brick;
    const int stride_y = size[0] + 1, stride_z = stride_y * (size[1] + 1);
    const int n_corners = stride_z * (size[2] + 1);
    for (int a = 0; a < 8; ++a)
        brick.step[a] = (a & 1) + stride_y * (a >> 1 & 1) + stride_z * (a >> 2);
    brick.n_local = n_corners + lane_count;
    brick.first_local = static_cast<int>(corner_of_local_.size());
    corner_of_local_.resize(brick.first_local + brick.n_local, -1);

    std::vector<int> domain_of_slot(n_corners + lane_count, -1);
    for (const int p : domains) {
        const auto& cell = lattice.cell[p];
        const int slot =
            cell[0] - low[0] + stride_y * (cell[1] - low[1]) + stride_z * (cell[2] - low[2]);
        domain_of_slot[slot] = p;
        for (int a = 0; a < 8; ++a)
            corner_of_local_[brick.first_local + slot + brick.step[a]] = lattice.corners[p][a];
    }
    const Lanes zero{};
    for (int slot = 0; slot < n_corners; slot += lane_count) {
        const auto first = domain_of_slot.begin() + slot;
        if (std::all_of(first, first + lane_count, [](int p) { return p < 0; }))
            continue;
        alignas(64) Lanes volume = zero, mu = zero, lambda = zero, law = zero - 1.0,
                          hourglass = zero;
        unsigned laws = 0;
        for (int l = 0; l < lane_count; ++l) {
            const int p = first[l];
            brick.domain.push_back(p);
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
        brick.batch.push_back(slot);
        brick.laws.push_back(laws);
        brick.volume.push_back(volume);
        brick.mu.push_back(mu);
        brick.lambda.push_back(lambda);
        brick.law.push_back(law);
        brick.hourglass.push_back(hourglass);
        brick.weight.push_back(volume * mu);
    }
    brick.stiffness.assign(45 * brick.batch.size(), FloatLanes{});
    bricks_.push_back(std::move(brick));
}

BrickFields Elasticity::fields(const Brick& brick) {
    BrickFields fields;
    for (int i = 0; i < 3; ++i) {
        fields.in[i] = in_[i].data() + brick.first_local;
        fields.out[i] = out_[i].data() + brick.first_local;
        fields.out_right[i] = out_right_[i].data() + brick.first_local;
    }
    return fields;
}

void Elasticity::load(const Vec3p* values) {
    for_chunks(
        static_cast<int>(corner_of_local_.size()), corner_chunk, [&](int begin, int end) {
            for (int l = begin; l < end; ++l) {
                const int c = corner_of_local_[l];
                const Vec3p value = c >= 0 ? values[c] : Vec3p{};
                for (int i = 0; i < 3; ++i) {
                    in_[i][l] = value[i];
                    out_[i][l] = 0;
                    out_right_[i][l] = 0;
                }
            }
        });
}

void Elasticity::sum_to_corners(Vec3p* values) const {
    for_chunks(
        static_cast<int>(sources_start_.size()) - 1, corner_chunk, [&](int begin, int end) {
            for (int c = begin; c < end; ++c) {
                Vec3p sum{};
                for (int k = sources_start_[c]; k < sources_start_[c + 1]; ++k) {
                    const int l = sources_[k], left = l - 1;
                    sum += Vec3p{out_[0][l], out_[1][l], out_[2][l], 0};
                    if (l > 0)
                        sum += Vec3p{
                            out_right_[0][left], out_right_[1][left], out_right_[2][left], 0};
                }
                values[c] = sum;
            }
        });
}

template <class Kernel>
void Elasticity::for_bricks(const Kernel& kernel) {
    for_chunks(static_cast<int>(bricks_.size()), 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            kernel(bricks_[k]);
    });
}

double Elasticity::energy_and_gradient(const Vec3p* x, Vec3p* gradient) {
    load(x);
    const double energy =
        sum_chunks(static_cast<int>(bricks_.size()), 1, [&](int begin, int end) {
            double sum = 0;
            for (int k = begin; k < end; ++k)
                sum += add_brick_gradient(bricks_[k], edge_, fields(bricks_[k]));
            return sum;
        });
    sum_to_corners(gradient);
    return energy;
}

void Elasticity::linearize(const Vec3p* x, bool project) {
    load(x);
    for_bricks([&](Brick& brick) {
        linearize_brick(brick, edge_, fields(brick));
        if (project)
            project_brick(brick, edge_, fields(brick));
    });
}

void Elasticity::product(const Vec3p* u, Vec3p* product) {
    load(u);
    for_bricks([&](Brick& brick) { add_brick_product(brick, edge_, fields(brick)); });
    sum_to_corners(product);
}

void Elasticity::diagonal(Vec3p* diagonal) {
    for (auto* sums : {&out_, &out_right_})
        for (auto& component : *sums)
            std::fill(component.begin(), component.end(), 0.0);
    for_bricks([&](Brick& brick) { add_brick_diagonal(brick, edge_, fields(brick)); });
    sum_to_corners(diagonal);
}

Elasticity::SmallestJ Elasticity::smallest_J(const Vec3p* x) {
    load(x);
    SmallestJ smallest{2e300, -1};
    for (const Brick& brick : bricks_)
        for (std::size_t b = 0; b < brick.batch.size(); ++b) {
            const Lanes J = brick_J(brick, static_cast<int>(b), edge_, fields(brick));
            for (int l = 0; l < lane_count; ++l)
                if (brick.domain[lane_count * b + l] >= 0 && !(J[l] >= smallest.J))
                    smallest = {J[l], brick.domain[lane_count * b + l]};
        }
    return smallest;
}

}  // namespace sim
