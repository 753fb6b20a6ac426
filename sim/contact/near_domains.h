// Which domains of a body may hold which vertices of another.
#pragma once

#include "sim/contact/contact_surface.h"

#include <span>
#include <vector>

namespace sim {

/// Vertices of one body, and for each of them the domains of the shell of another near it, all ascending.
struct NearDomains {
    std::vector<int> vertices, domains;  // of the bodies
    std::vector<int> first{0}, nearby;   // (#vertices + 1), (#pairs) places in `domains`

    /// Of the k-th vertex, as places in `domains`.
    std::span<const int> of_vertex(std::size_t k) const {
        return {nearby.data() + first[k], nearby.data() + first[k + 1]};
    }

    void add(int vertex, std::span<const int> places) {
        vertices.push_back(vertex);
        nearby.insert(nearby.end(), places.begin(), places.end());
        first.push_back(static_cast<int>(nearby.size()));
    }
};

/// Of `vertices`, ascending, at x (#C): domains whose balls, of what their maps are continued to by the share `beyond` of a
/// domain, hold the vertex or are no further than `ahead` [m] from it.
NearDomains near_domains(const ContactSurface& of_vertices,
                         std::span<const int> vertices,
                         const ContactSurface& of_domains,
                         const Field& x,
                         double beyond,
                         double ahead);

/// What is listed of some of the vertices, ascending.
NearDomains only(const NearDomains& near, std::span<const int> vertices);

}  // namespace sim
