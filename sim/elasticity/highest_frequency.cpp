#include "sim/elasticity/highest_frequency.h"

#include "sim/base/parallel.h"

#include <cmath>
#include <random>

namespace sim {

namespace {

constexpr int most_products = 100;
constexpr double settled = 2e-4;  // growth of w in a product
constexpr int chunk = 8192;

/// Σ m |u|².
double squared_norm(const Field& u, const std::vector<double>& mass) {
    return sum_chunks(static_cast<int>(u.size()), chunk, [&](int begin, int end) {
        double sum = 0;
        for (int c = begin; c < end; ++c)
            sum += mass[c] * dot(u[c], u[c]);
        return sum;
    });
}

/// Neighbours that move against each other, as in the fastest modes, and something of all others.
Field first_guess(const Lattice& lattice) {
    std::mt19937 random(1);
    const auto number = [&] { return random() / double(std::mt19937::max()); };
    Field u;
    for (const auto& [i, j, k] : lattice.corner_cell)
        u.push_back(((i + j + k) % 2 ? -1.0 : 1.0) * Vec3p{number(), number(), number(), 0});
    return u;
}

}  // namespace

double highest_frequency(ElasticEnergy& energy, const Lattice& lattice) {
    Field x;
    for (const Vec3& X : lattice.corner_rest)
        x.push_back(padded(X));
    energy.linearize(x.data(), true);
    Field u = first_guess(lattice), product(u.size());
    double frequency = 0, before = squared_norm(u, lattice.corner_mass);
    for (int k = 0; k < most_products; ++k) {
        // |M⁻¹ K u| / |u| grows from product to product, to w².
        energy.product(u.data(), product.data());
        const double scale = 1 / std::sqrt(before);
        for (std::size_t c = 0; c < u.size(); ++c)
            u[c] = (scale / lattice.corner_mass[c]) * product[c];
        before = squared_norm(u, lattice.corner_mass);
        const double slower = frequency;
        frequency = std::sqrt(std::sqrt(before));
        if (frequency < (1 + settled) * slower)
            break;
    }
    return frequency;
}

}  // namespace sim
