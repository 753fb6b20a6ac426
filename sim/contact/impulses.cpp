#include "sim/contact/impulses.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double settled = 1e-4;  // of a change of depth in a sweep, in domain edges
constexpr int most_sweeps = 100;

}  // namespace

Impulses::Impulses(const CornerMap& map,
                   const std::vector<double>& inverse_mass,
                   const Field& is_free,
                   double dt)
    : map_(map),
      inverse_mass_(inverse_mass),
      is_free_(is_free),
      dt_(dt),
      place_(map.n_dofs(), -1) {}

void Impulses::add(const Touch& touch, std::span<const Share> shares) {
    Impulse impulse{touch, static_cast<int>(weights_.size())};
    if (shares.size() == 1)
        add_row(shares[0]);
    else
        for (const Share& share : shares)
            add_to_sum(share, impulse.first);
    impulse.last = static_cast<int>(weights_.size());
    Vec3p sum{};
    for (int k = impulse.first; k < impulse.last; ++k) {
        const auto& [i, w] = weights_[k];
        sum += w * w * inverse_mass(i);
        place_[i] = -1;
    }
    const Vec3 inverse = unpadded(sum);
    impulse.inverse_along = touch.normal.cwiseAbs2().dot(inverse);
    impulse.inverse_across = inverse.maxCoeff();
    if (impulse.inverse_along > 0)
        impulses_.push_back(impulse);
    else
        weights_.resize(impulse.first);  // held on all sides
}

void Impulses::add_row(const Share& share) {
    map_.find_row(share.corner, row_);
    for (const auto& [i, w] : row_)
        weights_.push_back({i, share.weight * w});
}

void Impulses::add_to_sum(const Share& share, int first) {
    map_.find_row(share.corner, row_);
    for (const auto& [i, w] : row_) {
        if (place_[i] < first) {
            place_[i] = static_cast<int>(weights_.size());
            weights_.push_back({i, 0});
        }
        weights_[place_[i]].weight += share.weight * w;
    }
}

void Impulses::settle(Field& q) {
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        double change = 0;
        for (Impulse& impulse : impulses_)
            change = std::max(change, settle(impulse, q));
        if (change < settled)
            break;
    }
}

/// Changes q so that this contact alone ends the step where it touches, or open and without a push, and what slides then is
/// held by friction. Returns by how much its depth has changed, in domain edges.
double Impulses::settle(Impulse& impulse, Field& q) const {
    const auto& [normal, gap, edge, friction, carried] = impulse.touch;
    const std::span weights(weights_.begin() + impulse.first, weights_.begin() + impulse.last);
    Vec3p sum{};
    for (const auto& [i, w] : weights)
        sum += w * q[i];
    const Vec3 rate = unpadded(sum) - carried;
    const double along = normal.dot(rate),
                 push =
                     std::max(0.0, impulse.push - (gap / dt_ + along) / impulse.inverse_along),
                 most = push > 0 && friction.stick ? infinity : friction.coefficient * push;
    Vec3 hold = impulse.hold - (rate - along * normal) / impulse.inverse_across;
    if (const double size = hold.norm(); size > most)
        hold *= most / size;
    const double change = push - impulse.push;
    const Vec3p added = padded(change * normal + hold - impulse.hold);
    for (const auto& [i, w] : weights)
        q[i] += w * inverse_mass(i) * added;
    impulse.push = push;
    impulse.hold = hold;
    return std::abs(change) * impulse.inverse_along * dt_ / edge;
}

}  // namespace sim
