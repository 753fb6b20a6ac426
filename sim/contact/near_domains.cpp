#include "sim/contact/near_domains.h"

#include "sim/contact/domain_hull.h"
#include "sim/contact/point_grid.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr double listed_ahead = 0.25;  // in domain edges
constexpr double most_used =
    0.3;  // of that from one call to the next; where bodies move by more, nothing is listed ahead
constexpr double rounding = 1e-9;  // of distances, in domain edges

/// Takes over those domains that any vertex has, of which `nearby` are the places.
void keep_used(const std::vector<int>& domains, NearDomains& near) {
    std::vector<int> place(domains.size(), -1);
    for (const int i : near.nearby)
        place[i] = 0;
    for (std::size_t i = 0; i < domains.size(); ++i)
        if (place[i] == 0) {
            place[i] = static_cast<int>(near.domains.size());
            near.domains.push_back(domains[i]);
        }
    for (int& i : near.nearby)
        i = place[i];
}

}  // namespace

NearDomains near_domains(const ContactSurface& of_vertices,
                         std::span<const int> vertices,
                         const ContactSurface& of_domains,
                         const Field& x,
                         double beyond,
                         double ahead) {
    NearDomains near;
    if (vertices.empty())
        return near;
    std::vector<Vec3> points;
    Bounds region;
    for (const int v : vertices) {
        points.push_back(of_vertices.vertices[v].position(x));
        region.add(points.back());
    }
    // Balls of the shell that reach there.
    std::vector<int> domains;
    std::vector<Ball> balls;
    std::vector<Vec3> centres;
    double largest = 0;
    for (const int p : of_domains.shell) {
        std::array<Vec3p, 8> corners = of_domains.domain_corners(p, x);
        go_beyond(beyond, corners);
        Ball ball(corners);
        const double radius = std::sqrt(ball.squared_radius) + ahead;
        if (!region.contains(unpadded(ball.centre), radius))
            continue;
        ball.squared_radius = radius * radius;
        domains.push_back(p);
        balls.push_back(ball);
        centres.push_back(unpadded(ball.centre));
        largest = std::max(largest, radius);
    }
    if (domains.empty())
        return near;
    const PointGrid grid(centres, largest);
    for (std::size_t k = 0; k < points.size(); ++k) {
        const std::size_t begin = near.nearby.size();
        grid.near(points[k], [&](int i) {
            if (balls[i].holds(padded(points[k])))
                near.nearby.push_back(i);
        });
        if (near.nearby.size() == begin)
            continue;
        std::sort(near.nearby.begin() + static_cast<std::ptrdiff_t>(begin), near.nearby.end());
        near.vertices.push_back(vertices[k]);
        near.first.push_back(static_cast<int>(near.nearby.size()));
    }
    keep_used(domains, near);
    return near;
}

NearDomains only(const NearDomains& near, std::span<const int> vertices) {
    NearDomains result;
    std::size_t k = 0;
    for (const int v : vertices) {
        while (k < near.vertices.size() && near.vertices[k] < v)
            ++k;
        if (k == near.vertices.size())
            break;
        if (near.vertices[k] != v)
            continue;
        const std::span<const int> nearby = near.of_vertex(k);
        result.nearby.insert(result.nearby.end(), nearby.begin(), nearby.end());
        result.vertices.push_back(v);
        result.first.push_back(static_cast<int>(result.nearby.size()));
    }
    keep_used(near.domains, result);
    return result;
}

NearDomainLists::NearDomainLists(std::span<const ContactSurface> bodies)
    : bodies_(bodies), lists_(bodies.size() * bodies.size()), moved_(bodies.size()) {
    for (const ContactSurface& body : bodies) {
        double most = 1;
        for (const ContactVertex& vertex : body.vertices) {
            double sum = 0;
            for (const double w : vertex.weights)
                sum += std::abs(w);
            most = std::max(most, sum);
        }
        of_vertex_.push_back(most);
    }
}

void NearDomainLists::see() {
    moved_.assign(bodies_.size(), std::nullopt);
    is_at_look_ = false;
    ++n_seen_;
}

const PaddedBounds& NearDomainLists::moved(int b, const Field& x) {
    if (!moved_[b]) {
        PaddedBounds& moved = moved_[b].emplace();
        const int begin = bodies_[b].begin, end = begin + bodies_[b].lattice->n_corners();
        for (int c = begin; c < end; ++c)
            moved.add(x[c] - looked_at_[c]);
    }
    return *moved_[b];
}

double NearDomainLists::approach(int a, int b, const Field& x, double beyond) {
    // A vertex moves in the box of what its corners move, made wider where not all of its weights are positive; the centre
    // of a domain in that of its own. What is continued moves as a mean of corners and a multiple of what these part
    // (FoldWatch): its distance from the centre changes by no more than that multiple, and once more, of the size of the box.
    const double continued =
        std::pow(1 + 2 * beyond, 3);  // the sum of its weights without their signs
    const PaddedBounds &of_a = moved(a, x), &of_b = moved(b, x);
    const Vec3p middle = (of_a.low + of_a.high) / 2,
                half = of_vertex_[a] * (of_a.high - middle);
    const PaddedBounds of_vertex{middle - half, middle + half};
    return of_vertex.farthest(of_b) + (1 + continued) / 2 * of_b.farthest(of_b)
           + rounding * bodies_[b].lattice->edge;
}

void NearDomainLists::look(const Field& x, double way) {
    double edge = std::numeric_limits<double>::infinity();
    for (const ContactSurface& body : bodies_)
        edge = std::min(edge, body.lattice->edge);
    ahead_ = way < n_seen_ * most_used * listed_ahead * edge ? listed_ahead * edge : 0;
    looked_at_ = x;
    moved_.assign(bodies_.size(), std::nullopt);
    n_seen_ = 0;
    is_at_look_ = true;
    for (List& list : lists_)
        list.is_made = false;
}

const NearDomains& NearDomainLists::near(int a, int b, const Field& x, double beyond) {
    List& list = lists_[a * bodies_.size() + b];
    const double way = looked_at_.empty() ? 0 : approach(a, b, x, beyond);
    if (!(list.is_made && beyond <= list.beyond && way <= ahead_)) {
        if (!is_at_look_)
            look(x, way);
        list.near =
            near_domains(bodies_[a], bodies_[a].all_vertices(), bodies_[b], x, beyond, ahead_);
        list.beyond = beyond;
        list.is_made = true;
    }
    return list.near;
}

}  // namespace sim
