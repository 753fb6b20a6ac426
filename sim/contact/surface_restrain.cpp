// Contact in explicit steps: impulses on the degrees of freedom.
#include "sim/contact/contact_search.h"
#include "sim/contact/impulses.h"
#include "sim/contact/surface_contact.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sim {

namespace {

constexpr double enough = 1e-4;  // of a depth that may stay, in domain edges
constexpr int most_rounds = 8;
// That corners may go: what lies outside of them goes up to eight times as far.
constexpr double share_of_margin = 0.06;

std::array<Impulses::Share, 16> shares_of(const ContactPoint& contact) {
    std::array<Impulses::Share, 16> shares;
    for (int a = 0; a < 8; ++a) {
        shares[2 * a] = {contact.vertex->corners[a], contact.vertex->weights[a]};
        shares[2 * a + 1] = {contact.corners[a], -contact.weights[a]};
    }
    return shares;
}

}  // namespace

std::optional<double> SurfaceContact::restrain(Impulses& impulses, Field& q, Field& v) const {
    if (contacts_.empty())
        return std::nullopt;
    impulses.begin_drift(dt_);
    // Contacts that would end inside, then those that the impulses of these bring inside.
    const Field q_before = q;
    std::vector<char> is_in(contacts_.size(), 0);
    for (int round = 0; round < most_rounds; ++round) {
        const std::size_t before = impulses.size();
        for (std::size_t k = 0; k < contacts_.size(); ++k) {
            const Contact& contact = contacts_[k];
            if (is_in[k]
                || !(-contact.start_gap - dt_ * contact.normal.dot(contact.separation(v))
                     > enough * contact.edge))
                continue;
            is_in[k] = 1;
            impulses.add({contact.normal,
                          contact.start_gap,
                          contact.edge,
                          pairs_[contact.pair].friction},
                         impulses.row_of(shares_of(contact)));
        }
        if (impulses.size() == before)
            break;
        impulses.settle(q, v);
    }
    if (impulses.size() == 0)
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
    for (auto begin = before.begin(); begin != before.end();) {
        const int k = begin->pair;
        const Pair& pair = pairs_[k];
        std::vector<int> vertices;
        for (; begin != before.end() && begin->pair == k; ++begin)
            if (vertices.empty() || vertices.back() != begin->index)
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
