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
                   const Field& is_free)
    : map_(map), inverse_mass_(inverse_mass), is_free_(is_free) {}

void Impulses::begin_drift(double dt) {
    dt_ = dt;
    impulses_.clear();
}

Impulses::Row Impulses::row_of(int corner) {
    if (row_of_corner_.empty())
        row_of_corner_.assign(map_.dof_of_corner().size(), -1);
    int& k = row_of_corner_[corner];
    if (k < 0) {
        k = static_cast<int>(rows_.size());
        rows_.push_back(row_of({{Share{corner, 1}}}));
    }
    return rows_[k];
}

Impulses::Row Impulses::row_of(std::span<const Share> shares) {
    if (place_.empty())
        place_.assign(map_.n_dofs(), -1);
    const int first = static_cast<int>(weights_.size());
    for (const auto& [corner, factor] : shares) {
        map_.find_row(corner, row_);
        for (const auto& [i, w] : row_) {
            if (place_[i] < 0) {
                place_[i] = static_cast<int>(weights_.size());
                weights_.push_back({i, 0});
            }
            weights_[place_[i]].weight += factor * w;
        }
    }
    Row row{first, static_cast<int>(weights_.size())};
    for (int k = row.first; k < row.last; ++k) {
        const auto& [i, w] = weights_[k];
        row.inverse_mass += w * w * inverse_mass(i);
        place_[i] = -1;
    }
    return row;
}

int Impulses::add(const Touch& touch, const Row& row) {
    Impulse impulse{touch, row};
    const Vec3 inverse = unpadded(row.inverse_mass);
    impulse.inverse_along = touch.normal.cwiseAbs2().dot(inverse);
    impulse.inverse_across = inverse.maxCoeff();
    if (!(impulse.inverse_along > 0))
        return -1;
    impulses_.push_back(impulse);
    return static_cast<int>(impulses_.size()) - 1;
}

double Impulses::settle(Field& q, Field& v) {
    const double most = settle(q);
    map_.add_applied(change_, v);
    return most;
}

double Impulses::settle(Field& q, std::span<const int> corners, Field& v) {
    const double most = settle(q);
    map_.add_applied_at(corners, change_, v);
    return most;
}

double Impulses::settle(Field& q) {
    change_ = q;
    sweep(q);
    double squared = 0;
    for (std::size_t i = 0; i < q.size(); ++i) {
        change_[i] = q[i] - change_[i];
        squared = std::max(squared, dot(change_[i], change_[i]));
    }
    return std::sqrt(squared);  // T takes means
}

void Impulses::sweep(Field& q) {
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
    const std::span weights(weights_.begin() + impulse.row.first,
                            weights_.begin() + impulse.row.last);
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
