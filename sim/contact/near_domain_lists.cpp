#include "sim/contact/near_domain_lists.h"

#include "sim/contact/padded_bounds.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr double most_ahead = 0.25;  // in domain edges

/// Of corners since they were at `before`.   [m]
PaddedBounds moved(const ContactSurface& body, const Field& before, const Field& x) {
    PaddedBounds moved;
    for (std::size_t c = 0; c < before.size(); ++c)
        moved.add(x[body.begin + c] - before[c]);
    return moved;
}

void keep_corners(const ContactSurface& body, const Field& x, Field& corners) {
    const auto begin = x.begin() + body.begin;
    corners.assign(begin, begin + body.lattice->n_corners());
}

}  // namespace

NearDomainLists::NearDomainLists(std::span<const ContactSurface> bodies)
    : bodies_(bodies), lists_(bodies.size() * bodies.size()) {}

double NearDomainLists::approach(const List& list, int a, int b, const Field& x) const {
    // A vertex moves in the box of what its corners move, made wider where not all of its weights are positive; the centre
    // of a domain in that of its own. What is continued moves as a mean of corners and a multiple of what these part
    // (FoldWatch): its distance from the centre changes by no more than that multiple, and once more, of the size of the box.
    // The sum of its weights without their signs.
    const double continued = std::pow(1 + 2 * list.beyond, 3);
    const PaddedBounds of_a = moved(bodies_[a], list.of_a, x),
                       of_b = moved(bodies_[b], list.of_b, x);
    const Vec3p middle = (of_a.low + of_a.high) / 2,
                half = bodies_[a].largest_weight_sum * (of_a.high - middle);
    const PaddedBounds of_vertex{middle - half, middle + half};
    return of_vertex.farthest(of_b) + (1 + continued) / 2 * of_b.farthest(of_b)
           + LookAhead::rounding * bodies_[b].lattice->edge;
}

const NearDomains& NearDomainLists::near(int a, int b, const Field& x, double beyond) {
    List& list = lists_[a * bodies_.size() + b];
    list.look.count();
    const double change = list.beyond < 0 ? 0 : approach(list, a, b, x);
    if (beyond <= list.beyond && list.look.stands(change))
        return list.near;
    const ContactSurface &of_vertices = bodies_[a], &of_domains = bodies_[b];
    const double ahead = list.look.renew(change, most_ahead * of_domains.lattice->edge);
    list.near =
        near_domains(of_vertices, of_vertices.all_vertices(), of_domains, x, beyond, ahead);
    list.beyond = beyond;
    keep_corners(of_vertices, x, list.of_a);
    keep_corners(of_domains, x, list.of_b);
    return list.near;
}

}  // namespace sim
