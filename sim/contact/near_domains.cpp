#include "sim/contact/near_domains.h"

#include "sim/contact/domain_hull.h"
#include "sim/contact/point_grid.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

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

}  // namespace sim
