// Contact in explicit steps: impulses on the degrees of freedom.
#include "sim/contact/contact_search.h"
#include "sim/contact/surface_contact.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double enough = 1e-4;  // of a depth that may stay, in domain edges
constexpr int most_sweeps = 100;
constexpr int most_rounds = 8;
constexpr double share_of_margin =
    0.06;  // that corners may go: what lies outside of them goes up to eight times as far

/// A contact as the degrees of freedom q see it, p - o moves by Σ_i w_i q_i, and what it has been given so far.
class Impulse {
  public:
    Impulse(const ContactPoint& contact,
            double gap,
            const Friction& friction,
            std::vector<CornerMap::Weight> weights,
            const Field& inverse_mass)
        : normal_(contact.normal),
          gap_(gap),
          edge_(contact.edge),
          friction_(friction),
          weights_(std::move(weights)) {
        Vec3p sum{};
        for (const auto& [i, w] : weights_)
            sum += w * w * inverse_mass[i];
        const Vec3 inverse = unpadded(sum);
        inverse_along_ = normal_.cwiseAbs2().dot(inverse);
        inverse_across_ = inverse.maxCoeff();
    }

    /// Changes q so that this contact alone ends the step of dt where it touches, or open and without a push, and what slides
    /// then is held by friction. Returns by how much its depth has changed, in domain edges.
    double settle(double dt, const Field& inverse_mass, Field& q) {
        Vec3p sum{};
        for (const auto& [i, w] : weights_)
            sum += w * q[i];
        if (!(inverse_along_ > 0))
            return 0;
        const Vec3 rate = unpadded(sum);
        const double along = normal_.dot(rate),
                     push = std::max(0.0, push_ - (gap_ / dt + along) / inverse_along_),
                     most = friction_.stick ? infinity : friction_.coefficient * push;
        Vec3 hold = hold_ - (rate - along * normal_) / inverse_across_;
        if (const double size = hold.norm(); size > most)
            hold *= most / size;
        const double change = push - push_;
        const Vec3p impulse = padded(change * normal_ + hold - hold_);
        for (const auto& [i, w] : weights_)
            q[i] += w * inverse_mass[i] * impulse;
        push_ = push;
        hold_ = hold;
        return std::abs(change) * inverse_along_ * dt / edge_;
    }

  private:
    Vec3 normal_;
    double gap_ = 0, edge_ = 0;  // at the start of the step, a domain's [m]
    Friction friction_;
    std::vector<CornerMap::Weight> weights_;
    double inverse_along_ = 0, inverse_across_ = 0;  // mass that is pushed and held [1/kg]
    double push_ = 0;                                // along the normal, never negative [N s]
    Vec3 hold_{0, 0, 0};                             // across it [N s]
};

/// The weights of p - o in the degrees of freedom, each of these once.
class Rows {
  public:
    explicit Rows(const CornerMap& map) : map_(map), slot_(map.n_dofs(), -1) {}

    std::vector<CornerMap::Weight> of(const ContactPoint& contact) {
        std::vector<CornerMap::Weight> sum;
        for (int a = 0; a < 8; ++a) {
            add(contact.vertex->corners[a], contact.vertex->weights[a], sum);
            add(contact.corners[a], -contact.weights[a], sum);
        }
        for (const auto& [i, w] : sum)
            slot_[i] = -1;
        return sum;
    }

  private:
    void add(int corner, double factor, std::vector<CornerMap::Weight>& sum) {
        map_.find_row(corner, row_);
        for (const auto& [i, w] : row_) {
            if (slot_[i] < 0) {
                slot_[i] = static_cast<int>(sum.size());
                sum.push_back({i, 0});
            }
            sum[slot_[i]].weight += factor * w;
        }
    }

    const CornerMap& map_;
    std::vector<int> slot_;  // (#dofs) of the sum that is being made, -1: none
    std::vector<CornerMap::Weight> row_;
};

}  // namespace

std::optional<double> SurfaceContact::restrain(const Field& x,
                                               const CornerMap& map,
                                               const Field& inverse_mass,
                                               double dt,
                                               Field& q) const {
    if (contacts_.empty())
        return std::nullopt;
    // Contacts that would end inside, then those that the impulses of these bring inside.
    const Field q_before = q;
    Rows rows(map);
    std::vector<Impulse> impulses;
    std::vector<char> is_in(contacts_.size(), 0);
    Field buffer(x.size());
    for (int round = 0; round < most_rounds; ++round) {
        const Field& v = map.applied(q, buffer);
        const std::size_t before = impulses.size();
        for (std::size_t k = 0; k < contacts_.size(); ++k) {
            const Contact& contact = contacts_[k];
            const Vec3 start = contact.separation(x);
            if (is_in[k]
                || !(contact.depth(start + dt * contact.separation(v)) > enough * contact.edge))
                continue;
            is_in[k] = 1;
            impulses.emplace_back(contact,
                                  contact.gap + contact.normal.dot(start),
                                  pairs_[contact.pair].friction,
                                  rows.of(contact),
                                  inverse_mass);
        }
        if (impulses.size() == before)
            break;
        for (int sweep = 0; sweep < most_sweeps; ++sweep) {
            double change = 0;
            for (Impulse& impulse : impulses)
                change = std::max(change, impulse.settle(dt, inverse_mass, q));
            if (change < enough / 10)
                break;
        }
    }
    if (impulses.empty())
        return std::nullopt;
    double squared = 0;
    for (std::size_t i = 0; i < q.size(); ++i)
        squared = std::max(squared, dot(q[i] - q_before[i], q[i] - q_before[i]));
    return std::sqrt(squared);
}

bool SurfaceContact::is_linear_enough(const Field& x, double way, double tolerance) {
    // A vertex that no contact was made of must go further than the margin to get inside.
    for (const Pair& pair : pairs_)
        if (!(way < share_of_margin * pair.margin))
            return false;
    // Depths of p - o that moves by u change as if linear but for 2 |u|, where the normal turns by less than 60 degrees. What
    // may change by more, and may touch, is looked at again.
    std::vector<Contact> before, after;
    for (const Contact& contact : contacts_) {
        const Vec3 apart = contact.separation(x);
        const double most = 2 * apart.norm();
        if (most < tolerance * contact.edge || contact.gap + contact.normal.dot(apart) > most)
            continue;
        if (pairs_[contact.pair].is_self())
            return false;
        before.push_back(contact);
    }
    near_.see();
    for (auto begin = before.begin(); begin != before.end();) {
        const int k = begin->pair;
        const Pair& pair = pairs_[k];
        std::vector<int> vertices;
        for (; begin != before.end() && begin->pair == k; ++begin)
            vertices.push_back(begin->index);
        for (const ContactPoint& point : find_listed_contacts(bodies_[pair.of_vertices],
                                                              only(near(pair, x), vertices),
                                                              bodies_[pair.of_domains],
                                                              x,
                                                              x_n_,
                                                              pair.margin))
            after.push_back(prepared(point, k));
    }
    return mismatch(before, after, x) < tolerance;
}

}  // namespace sim
