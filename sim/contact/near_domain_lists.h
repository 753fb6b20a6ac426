// Lists of near domains, kept from step to step.
#pragma once

#include "sim/contact/look_ahead.h"
#include "sim/contact/near_domains.h"

#include <span>
#include <vector>

namespace sim {

/// Keeps near_domains() of all vertices for pairs of bodies: a list is made ahead, and stands while no vertex can have come so
/// much nearer to a domain. So it only saves work: listed is all that is near, and more that depends on when it was listed.
class NearDomainLists {
  public:
    /// `bodies` outlive the lists.
    explicit NearDomainLists(std::span<const ContactSurface> bodies);

    /// Of all vertices of body a and domains of body b at x (#C), continued by the share `beyond` of a domain or more. Stays as
    /// it is until the next call for the same bodies.
    const NearDomains& near(int a, int b, const Field& x, double beyond);

  private:
    struct List {
        NearDomains near;
        double beyond = -1;  // none is made yet
        LookAhead look;
        Field of_a, of_b;  // (#corners) when it was made [m]
    };

    /// By how much a vertex of a may have come nearer to what is looked for in a ball of b since the list was made.   [m]
    double approach(const List& list, int a, int b, const Field& x) const;

    std::span<const ContactSurface> bodies_;
    std::vector<List> lists_;  // (#bodies × #bodies)
};

}  // namespace sim
