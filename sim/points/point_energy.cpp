#include "sim/points/point_energy.h"

#include "sim/base/parallel.h"
#include "sim/base/volume_ratio.h"
#include "sim/materials/law.h"
#include "sim/points/plasticity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

constexpr int yielding_at_once = 64;

/// sup Σ_a w'_a²/w_a of a spline, in 1/cells².
double sharpest(Kernel kernel) {
    switch (kernel) {
        case Kernel::Quadratic:
            return 6;
        case Kernel::Cubic:
            return 3.04;
        default:
            return std::numeric_limits<double>::infinity();
    }
}

/// The number of a chunk's first batch: batches start at its first slave, and the last of a chunk may be short.
int first_batch(const CornerMap::Slaves& all, const CornerMap::Slaves& chunk) {
    return (chunk.begin - all.begin) / lane_count + chunk.chunk;
}

Model law_of(Model model) {
    return model == Model::Snow ? Model::FixedCorotated : model;
}

}  // namespace

PointEnergy::PointEnergy(const CornerMap& map,
                         int body,
                         int first_corner,
                         double cell_size,
                         const MaterialPoints& points)
    : map_(map),
      body_(body),
      first_corner_(first_corner),
      cell_size_(cell_size),
      points_(points),
      J_of_moduli_(points.size(), 1.0),
      F_next_(points.size()) {
    for (int p = 0; p < points.size(); ++p) {
        const Model model = law_of(points.model[points.region[p]]);
        law_.push_back(
            {points.volume[p], points.mu[p], points.lambda[p], static_cast<double>(model)});
        models_ |= 1u << static_cast<int>(model);
        scale_ += points.volume[p] * (points.lambda[p] + 2 * points.mu[p]);
    }
    const auto is_snow = [](Model model) { return model == Model::Snow; };
    if (std::none_of(points.model.begin(), points.model.end(), is_snow))
        return;
    for (std::size_t r = 0; r < points.model.size(); ++r) {
        const SnowOptions& snow = points.snow[r];
        limits_.push_back(is_snow(points.model[r]) ? StretchLimits{1 - snow.compression_limit,
                                                                   1 + snow.stretch_limit}
                                                   : StretchLimits{});
    }
}

void PointEnergy::begin_step(const PointState& state) {
    start_ = state;
    for (int p = 0; p < points_.size(); ++p)
        harden(p);
}

void PointEnergy::harden(int p) {
    if (start_.J_plastic[p] == J_of_moduli_[p] || !points_.is_snow(p))
        return;
    J_of_moduli_[p] = start_.J_plastic[p];
    const double harder =
        std::exp(points_.snow[points_.region[p]].hardening * (1 - start_.J_plastic[p]));
    law_[p].mu = harder * points_.mu[p];
    law_[p].lambda = harder * points_.lambda[p];
}

void PointEnergy::yield(const CornerMap::Slaves& at) {
    int point[yielding_at_once];
    for (int s = at.begin; s < at.end; s += yielding_at_once) {
        const int n = std::min(yielding_at_once, at.end - s);
        for (int k = 0; k < n; ++k)
            point[k] = map_.slave_corner()[s + k] - first_corner_;
        yield(point, n);
    }
}

void PointEnergy::yield(const int* point, int n) {
    if (sim::yield(points_, point, n, F_next_.data(), start_.F.data(), start_.J_plastic.data()))
        for (int k = 0; k < n; ++k)
            harden(point[k]);
}

PointsOfSlaves PointEnergy::slaves() const {
    return {map_.slave_corner().data(), first_corner_, law_.data(), models_, start_.F.data()};
}

double PointEnergy::sum_of_energies() const {
    double energy = 0;
    for (const double part : chunk_energy_)
        energy += part;
    return energy;
}

double PointEnergy::add_gradient(const Field& q, double dt, Field& gradient) {
    const PointsOfSlaves points = slaves();
    chunk_energy_.assign(map_.slaves_of(body_).chunk, 0);
    const CornerMap::AtSlaves take = [&](const CornerMap::Slaves& at, Gradient* values) {
        const SlaveRange range{at.begin, at.end};
        deform(points, range, dt, values, F_next_.data());
        chunk_energy_[at.chunk] = take_stresses(points, range, F_next_.data(), values);
    };
    map_.add_through(body_, q, take, gradient);
    return sum_of_energies();
}

double PointEnergy::end_drift(const Field& way, const Field& x_n, Field& x, Field& gradient) {
    const PointsOfSlaves points = slaves();
    const Yielding yielding{limits_.data(),
                            points_.region.data(),
                            [&](const int* point, int n) { yield(point, n); }};
    const Yielding* const yields = limits_.empty() ? nullptr : &yielding;
    chunk_energy_.assign(map_.slaves_of(body_).chunk, 0);
    const CornerMap::AtMovedSlaves take =
        [&](const CornerMap::Slaves& at, const Vec3p* gone, Gradient* values) {
            for (int s = at.begin; s < at.end; ++s) {
                const int c = map_.slave_corner()[s];
                x[c] = x_n[c] + gone[s - at.begin];
            }
            chunk_energy_[at.chunk] = deform_and_take_stresses(
                points, {at.begin, at.end}, yields, F_next_.data(), values);
        };
    map_.add_through(body_, way, take, gradient);
    return sum_of_energies();
}

void PointEnergy::add_start_gradient(Field& gradient) {
    const PointsOfSlaves points = slaves();
    map_.add_transposed(
        body_,
        CornerMap::Factor::Slope,
        [&](const CornerMap::Slaves& at, Gradient* values) {
            take_stresses(points, {at.begin, at.end}, points.F_n, values);
        },
        gradient);
}

void PointEnergy::linearize(const Field& q, double dt, bool project) {
    const PointsOfSlaves points = slaves();
    const CornerMap::Slaves all = map_.slaves_of(body_);
    const int n_batches = (all.end - all.begin) / lane_count + all.chunk + 1;
    stiffness_.resize(n_batches);
    weight_.resize(n_batches);
    map_.visit_gradients(
        body_, CornerMap::Factor::Slope, q, [&](const CornerMap::Slaves& at, Gradient* values) {
            const int b = first_batch(all, at);
            take_stiffness(
                points, {at.begin, at.end}, dt, values, project, &stiffness_[b], &weight_[b]);
        });
}

void PointEnergy::add_product(const Field& u, Field& product) const {
    const CornerMap::Slaves all = map_.slaves_of(body_);
    const CornerMap::AtSlaves take = [&](const CornerMap::Slaves& at, Gradient* values) {
        const int b = first_batch(all, at);
        multiply(&stiffness_[b], &weight_[b], {at.begin, at.end}, values);
    };
    map_.add_through(body_, u, take, product);
}

void PointEnergy::add_diagonal(Field& diagonal) const {
    const CornerMap::Slaves all = map_.slaves_of(body_);
    map_.add_transposed(
        body_,
        CornerMap::Factor::SlopeSquared,
        [&](const CornerMap::Slaves& at, Gradient* values) {
            const int b = first_batch(all, at);
            take_diagonal(&stiffness_[b], &weight_[b], {at.begin, at.end}, values);
        },
        diagonal);
}

void PointEnergy::advance(const Field& q, double dt) {
    const PointsOfSlaves points = slaves();
    map_.visit_gradients(
        body_, CornerMap::Factor::Slope, q, [&](const CornerMap::Slaves& at, Gradient* values) {
            deform(points, {at.begin, at.end}, dt, values, F_next_.data());
            yield(at);
        });
}

void PointEnergy::accept(PointState& state) {
    std::swap(state.F, F_next_);
    std::swap(state.J_plastic, start_.J_plastic);
}

double PointEnergy::highest_frequency(Kernel kernel) const {
    double most = 0;
    for (int p = 0; p < points_.size(); ++p)
        most = std::max(
            most, (3 * law_[p].lambda + 2 * law_[p].mu) * law_[p].volume / points_.mass[p]);
    return std::sqrt(most * sharpest(kernel)) / cell_size_;
}

double PointEnergy::energy(const PointState& state) const {
    double sum = 0;
    for (int p = 0; p < points_.size(); ++p) {
        const auto& [volume, mu, lambda, model] = law_[p];
        sum += volume * visit(static_cast<Model>(static_cast<int>(model)), [&](auto law) {
                   return law.energy_density(state.F[p], mu, lambda);
               });
    }
    return sum;
}

PointEnergy::SmallestJ PointEnergy::smallest_trial_J() const {
    SmallestJ smallest{std::numeric_limits<double>::infinity(), -1};
    for (int p = 0; p < points_.size(); ++p)
        if (const double J = determinant(F_next_[p]); is_worse(J, smallest.J))
            smallest = {J, p};
    return smallest;
}

}  // namespace sim
