#include "sim/elasticity/power_method.h"

#include "sim/base/parallel.h"

#include <cmath>

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

}  // namespace

double fastest_mode(Field u,
                    const std::vector<double>& mass,
                    const std::function<void(const Field& u, Field& Ku)>& product) {
    for (std::size_t c = 0; c < u.size(); ++c)
        u[c] = mass[c] > 0 ? u[c] : Vec3p{};
    Field Ku(u.size());
    double frequency = 0, before = squared_norm(u, mass);
    for (int k = 0; k < most_products; ++k) {
        // |M⁻¹ K u| / |u| grows from product to product, to w².
        product(u, Ku);
        const double scale = 1 / std::sqrt(before);
        for (std::size_t c = 0; c < u.size(); ++c)
            if (mass[c] > 0)
                u[c] = (scale / mass[c]) * Ku[c];
        before = squared_norm(u, mass);
        const double slower = frequency;
        frequency = std::sqrt(std::sqrt(before));
        if (frequency < (1 + settled) * slower)
            break;
    }
    return frequency;
}

}  // namespace sim
