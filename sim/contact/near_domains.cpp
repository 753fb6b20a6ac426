#include "sim/contact/near_domains.h"

#include "sim/base/parallel.h"
#include "sim/contact/domain_hull.h"
#include "sim/contact/padded_bounds.h"
#include "sim/contact/point_grid.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int chunk = 256;  // of vertices

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

/// Of the domains of a shell whose balls, made larger by `ahead`, reach into a region.
struct Balls {
    std::vector<int> domains;
    std::vector<Ball> balls;
    std::vector<Vec3> centres;
    double largest = 0;  // of their radii [m]

    Balls(const ContactSurface& body,
          const PaddedBounds& region,
          const Field& x,
          double beyond,
          double ahead) {
        for (const int p : body.shell) {
            std::array<Vec3p, 8> corners = body.domain_corners(p, x);
            go_beyond(beyond, corners);
            Ball ball(corners);
            const double radius = std::sqrt(ball.squared_radius) + ahead;
            if (!region.widened(radius).holds(ball.centre))
                continue;
            ball.squared_radius = radius * radius;
            domains.push_back(p);
            balls.push_back(ball);
            centres.push_back(unpadded(ball.centre));
            largest = std::max(largest, radius);
        }
    }
};

}  // namespace

NearDomains near_domains(const ContactSurface& of_vertices,
                         std::span<const int> vertices,
                         const ContactSurface& of_domains,
                         const Field& x,
                         double beyond,
                         double ahead) {
    if (vertices.empty())
        return {};
    std::vector<Vec3> points;
    PaddedBounds region;
    for (const int v : vertices) {
        points.push_back(of_vertices.vertices[v].position(x));
        region.add(padded(points.back()));
    }
    const Balls all(of_domains, region, x, beyond, ahead);
    NearDomains near;
    if (all.domains.empty())
        return near;
    // Vertices in chunks of a fixed size, in order.
    const PointGrid grid(all.centres, all.largest);
    const int n = static_cast<int>(points.size());
    std::vector<NearDomains> parts((n + chunk - 1) / chunk);
    for_chunks(n, chunk, [&](int begin, int end) {
        std::vector<int> places;
        for (int k = begin; k < end; ++k) {
            places.clear();
            grid.near(points[k], [&](int i) {
                if (all.balls[i].holds(padded(points[k])))
                    places.push_back(i);
            });
            std::sort(places.begin(), places.end());
            if (!places.empty())
                parts[begin / chunk].add(vertices[k], places);
        }
    });
    for (const NearDomains& part : parts)
        for (std::size_t k = 0; k < part.vertices.size(); ++k)
            near.add(part.vertices[k], part.of_vertex(k));
    keep_used(all.domains, near);
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
        result.add(v, near.of_vertex(k));
    }
    keep_used(near.domains, result);
    return result;
}

}  // namespace sim
