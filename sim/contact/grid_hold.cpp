#include "sim/contact/grid_hold.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sim {

namespace {

// Of k dt² / m: much firmer costs iterations, much softer passes.
constexpr double firmness = 16;
constexpr double settled = 1e-2;  // of a change of a force, against the largest
// By which that force moves what it acts on, in domain edges.
constexpr double least_way = 1e-6;
constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_before(const GridHold::Contact& contact, const GridHold::Place& place) {
    return contact.place < place;
}

double most_hold(const GridHold::Contact& contact) {
    if (!(contact.push > 0))
        return 0;
    return contact.friction.stick ? infinity : contact.friction.coefficient * contact.push;
}

}  // namespace

void GridHold::begin_step(const Field& x_n, double dt) {
    contacts_.clear();
    hessians_.clear();
    x_n_ = &x_n;
    dt_ = dt;
}

bool GridHold::has(const Place& place) const {
    const auto at = std::lower_bound(contacts_.begin(), contacts_.end(), place, is_before);
    return at != contacts_.end() && at->place == place;
}

double GridHold::stiffness(const Contact& contact) const {
    return firmness * contact.mass / (dt_ * dt_);
}

Vec3 GridHold::way(const Contact& contact, const Field& x) const {
    Vec3p sum{};
    for (const auto& [c, weight] : contact.shares)
        sum += weight * (x[c] - (*x_n_)[c]);
    return unpadded(sum);
}

GridHold::Force GridHold::force(const Contact& contact, const Field& x) const {
    const double k = stiffness(contact), most = most_hold(contact);
    const Vec3 u = way(contact, x);
    const double along = contact.normal.dot(u);
    Force force;
    force.push = std::max(0.0, contact.push - k * along);
    force.tried = contact.hold - k * (u - along * contact.normal);
    const double size = force.tried.norm();
    force.hold = size > most ? Vec3(force.tried * (most / size)) : force.tried;
    return force;
}

bool GridHold::update(const Field& x, std::vector<Contact> met) {
    std::vector<double> changes;
    for (Contact& contact : contacts_) {
        const auto [push, tried, hold] = force(contact, x);
        changes.push_back(std::hypot(push - contact.push, (hold - contact.hold).norm()));
        contact.push = push;
        contact.hold = hold;
    }
    for (Contact& contact : met) {
        changes.push_back(std::hypot(contact.push, contact.hold.norm()));
        contacts_.push_back(std::move(contact));
    }
    double largest = 0;
    for (const Contact& contact : contacts_)
        largest = std::max(largest, contact.push);
    bool is_settled = true;
    for (std::size_t i = 0; i < contacts_.size(); ++i)
        if (changes[i] > settled * largest
            && changes[i] > least_way * contacts_[i].edge * stiffness(contacts_[i]))
            is_settled = false;
    std::sort(contacts_.begin(), contacts_.end(), [](const Contact& a, const Contact& b) {
        return a.place < b.place;
    });
    return is_settled;
}

double GridHold::add_gradient(const Field& x, Field& gradient) const {
    double energy = 0;
    for (const Contact& contact : contacts_) {
        const auto [push, tried, hold] = force(contact, x);
        // D(tried) = hold·tried - |hold|²/2 on both sides of Coulomb's limit.
        energy += (push * push - contact.push * contact.push + 2 * hold.dot(tried)
                   - hold.squaredNorm() - contact.hold.squaredNorm())
                  / (2 * stiffness(contact));
        const Vec3p on_corners = padded(-push * contact.normal - hold);
        for (const auto& [c, weight] : contact.shares)
            gradient[c] += weight * on_corners;
    }
    return energy;
}

Mat3 GridHold::hessian(const Contact& contact, const Force& force) const {
    const double k = stiffness(contact), most = most_hold(contact);
    const Mat3 along = contact.normal * contact.normal.transpose();
    Mat3 H = Mat3::Zero();
    if (force.push > 0)
        H += k * along;
    const double size = force.tried.norm();
    if (size < most)
        return H + k * (Mat3::Identity() - along);
    if (size > 0) {
        const Vec3 direction = force.tried / size;
        H += k * most / size * (Mat3::Identity() - along - direction * direction.transpose());
    }
    return H;
}

void GridHold::linearize(const Field& x) {
    hessians_.clear();
    for (const Contact& contact : contacts_)
        hessians_.push_back(hessian(contact, force(contact, x)));
}

void GridHold::add_product(const Field& u, Field& product) const {
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        Vec3p sum{};
        for (const auto& [c, weight] : contacts_[i].shares)
            sum += weight * u[c];
        const Vec3p force = padded(hessians_[i] * unpadded(sum));
        for (const auto& [c, weight] : contacts_[i].shares)
            product[c] += weight * force;
    }
}

void GridHold::add_diagonal(Field& diagonal) const {
    for (std::size_t i = 0; i < contacts_.size(); ++i)
        for (const auto& [c, weight] : contacts_[i].shares)
            diagonal[c] += weight * weight * padded(hessians_[i].diagonal());
}

}  // namespace sim
