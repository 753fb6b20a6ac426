// Which domains of a body may hold which vertices of another.
#pragma once

#include "sim/contact/contact_surface.h"
#include "sim/contact/padded_bounds.h"

#include <optional>
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

/// Keeps them for pairs of bodies from step to step (a Verlet list [Ver67]): they are listed with balls larger than needed,
/// and that holds while no vertex can have come nearer to a domain by more. So it only saves work: listed is all that is
/// near, and more that depends on when it was listed.
class NearDomainLists {
  public:
    /// `bodies` outlive the lists.
    explicit NearDomainLists(std::span<const ContactSurface> bodies);

    /// Before near() of another x: how far bodies have moved is seen anew.
    void see();

    /// Of all vertices of body a and domains of body b at x (#C).
    const NearDomains& near(int a, int b, const Field& x, double beyond);

  private:
    struct List {
        NearDomains near;
        double beyond = 0;
        bool is_made = false;  // at the last look
    };

    /// By how much a vertex of a may have come nearer to what is looked for in a ball of b since the last look.   [m]
    double approach(int a, int b, const Field& x, double beyond);
    const PaddedBounds& moved(int b, const Field& x);
    void look(const Field& x, double way);

    std::span<const ContactSurface> bodies_;
    std::vector<double>
        of_vertex_;            // (#bodies) the most that one moves, when its corners move by 1
    std::vector<List> lists_;  // (#bodies × #bodies)
    Field looked_at_;          // (#C) at the last look [m]
    std::vector<std::optional<PaddedBounds>> moved_;  // (#bodies) by corners since then [m]
    double ahead_ = 0;                                // that was listed then [m]
    int n_seen_ = 0;                                  // since then
    bool is_at_look_ = false;                         // x is looked_at_
};

}  // namespace sim
