#include "sim/incremental_potential.h"

#include "sim/base/parallel.h"
#include "sim/base/vectors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

constexpr int chunk = 8192;
// Of a position after the sums of a step, relative to the largest coordinate.
constexpr double rounding = 1e-14;

/// Of all vectors, disregarding signs.
double largest_magnitude(const Field& field) {
    Vec3p low{}, high{};
    for (const Vec3p& v : field) {
        low = smaller(v, low);
        high = larger(v, high);
    }
    return largest_entry(larger(-low, high));
}

}  // namespace

/// act(elasticity, first corner) for bodies of domains; zero in `sums` for points.
template <class Act>
void IncrementalPotential::for_elastic(Field& sums, const Act& act) {
    for (const ElasticBody& body : bodies_)
        if (body.elasticity != nullptr)
            act(*body.elasticity, body.begin);
        else
            std::fill(sums.begin() + body.begin, sums.begin() + body.end, Vec3p{});
}

double IncrementalPotential::elastic_gradient(const Field& x, Field& gradient) {
    gradient.resize(x.size());
    double energy = 0;
    for_elastic(gradient, [&](ElasticEnergy& elasticity, int begin) {
        energy += elasticity.energy_and_gradient(&x[begin], &gradient[begin]);
    });
    return energy;
}

double IncrementalPotential::value_and_gradient(const Field& q, Field& gradient) {
    map_.move(step_.x_n, step_.dt, q, x_);
    double value = elastic_gradient(x_, corner_gradient_);
    for (const ContactEnergy* contact : contacts_)
        value += contact->add_gradient(x_, corner_gradient_);
    if (!std::isfinite(value))
        return value;

    if (!step_.static_force.empty())
        for (std::size_t c = 0; c < x_.size(); ++c) {
            value -= dot(step_.static_force[c], x_[c]);
            corner_gradient_[c] -= step_.static_force[c];
        }

    // dt Tᵀ ∂Φ/∂x + M (q - q~)
    const int n = static_cast<int>(q.size());
    inner_part_.resize(n);
    gradient.resize(n);
    const Field& force = map_.applied_transposed(corner_gradient_, inner_part_);
    for (GridEnergy* grid :
         grids_)  // points are never free: T is no identity, `force` is inner_part_
        value += grid->add_gradient(q, step_.dt, inner_part_);
    if (!std::isfinite(value))
        return value;
    value += sum_chunks(n, chunk, [&](int begin, int end) {
        Vec3p sum{};
        for (int i = begin; i < end; ++i) {
            const Vec3p change = q[i] - step_.q_tilde[i];
            const Vec3p impulse = step_.mass[i] * change;
            inner_part_[i] = step_.dt * force[i];
            gradient[i] = (impulse + inner_part_[i]) * step_.is_free[i];
            sum += impulse * change;
        }
        return 0.5 * (sum[0] + sum[1] + sum[2]);
    });
    return value;
}

void IncrementalPotential::linearize(const Field& q, bool project) {
    const int n = static_cast<int>(q.size());
    corner_diagonal_.resize(x_.size());
    corner_product_.resize(x_.size());
    for_elastic(corner_diagonal_, [&](ElasticEnergy& elasticity, int begin) {
        elasticity.linearize(&x_[begin], project);
        elasticity.diagonal(&corner_diagonal_[begin]);
    });
    const double largest_coordinate = largest_magnitude(x_);
    for (ContactEnergy* contact : contacts_) {
        contact->linearize(x_);
        contact->add_diagonal(corner_diagonal_);
    }

    grid_diagonal_.assign(n, Vec3p{});
    double grid_length = 0;
    for (GridEnergy* grid : grids_) {
        grid->linearize(q, step_.dt, project);
        grid->add_diagonal(grid_diagonal_);
        grid_length = std::max(grid_length, grid->length());
    }
    if (!grids_.empty())
        for (const Vec3p& velocity : q)
            grid_length = std::max(grid_length, step_.dt * std::sqrt(dot(velocity, velocity)));

    // The diagonal of M + dt² Tᵀ K T, and what rounding of positions does to dt Tᵀ ∂Φ/∂x.
    inverse_diagonal_.resize(n);
    map_.apply_squared_transposed(corner_diagonal_, inverse_diagonal_);
    const double dt_squared = step_.dt * step_.dt;
    const double noise_squared = sum_chunks(n, chunk, [&](int begin, int end) {
        double sum = 0;
        for (int i = begin; i < end; ++i) {
            const Vec3p stiffness = inverse_diagonal_[i];
            const Vec3p diagonal = step_.mass[i] + dt_squared * (stiffness + grid_diagonal_[i]);
            Vec3p inverse{};
            for (int k = 0; k < 3; ++k)
                inverse[k] = step_.is_free[i][k] > 0 && diagonal[k] > 0 ? 1 / diagonal[k] : 0;
            inverse_diagonal_[i] = inverse;
            const Vec3p rounded =
                largest_coordinate * stiffness + grid_length * grid_diagonal_[i];
            sum += dot(rounded * rounded, inverse);
        }
        return sum;
    });
    noise_ = rounding * step_.dt * std::sqrt(noise_squared);
}

double IncrementalPotential::hessian_product(const Field& p, Field& product) {
    const Field& u = map_.applied(p, corner_diagonal_);
    Field& at_corners = map_.is_identity() ? product : corner_product_;
    for_elastic(at_corners, [&](ElasticEnergy& elasticity, int begin) {
        elasticity.product(&u[begin], &at_corners[begin]);
    });
    for (const ContactEnergy* contact : contacts_)
        contact->add_product(u, at_corners);
    const Field& Ku = map_.applied_transposed(at_corners, product);
    for (const GridEnergy* grid : grids_)
        grid->add_product(p, product);
    const double dt_squared = step_.dt * step_.dt;
    return sum_chunks(static_cast<int>(p.size()), chunk, [&](int begin, int end) {
        Vec3p sum{};
        for (int i = begin; i < end; ++i) {
            product[i] = step_.mass[i] * p[i] + dt_squared * Ku[i];
            sum += p[i] * product[i];
        }
        return sum[0] + sum[1] + sum[2];
    });
}

double IncrementalPotential::value_noise() const {
    double scale = 0;
    for (const ElasticBody& body : bodies_)
        scale += body.energy_scale;
    for (const GridEnergy* grid : grids_)
        scale += grid->scale();
    return std::numeric_limits<double>::epsilon() * scale;
}

double IncrementalPotential::gradient_scale() const {
    const double inner = scaled_norm(inner_part_, inverse_diagonal_);
    if (step_.static_force.empty())
        return inner;
    // In statics the inner part itself vanishes in equilibrium: measure it against the load.
    Field load(inner_part_.size());
    map_.apply_transposed(step_.static_force, load);
    return std::max(inner, scaled_norm(load, inverse_diagonal_));
}

}  // namespace sim
