// Which vertices of one body are in another, or near it.
#pragma once

#include "sim/contact/contact_point.h"
#include "sim/contact/near_domains.h"

#include <span>
#include <vector>

namespace sim {

/// Of `vertices`, indices into those of `of_vertices`, the ones that are in `of_domains` at x (#C) or less than `margin`
/// [m] from it, in their order. The deformed domain that holds the vertex, or is nearest to it, its trilinear map inverted,
/// gives the rest point that the vertex has come to, and the distance field there the gap: it is measured at rest, where it
/// is known. A map is continued beyond its domain only where the body has none.
///
/// The normal is that of the nearest piece of the surface, or, for a vertex that was outside at x_n (#C), of the piece
/// that it has come through.
///
/// Of a body with itself domains within `neighbourhood` domain edges of the vertex at rest are left out.
std::vector<ContactPoint> find_contacts(const ContactSurface& of_vertices,
                                        std::span<const int> vertices,
                                        const ContactSurface& of_domains,
                                        const Field& x,
                                        const Field& x_n,
                                        double margin);

/// The same where near_domains() has listed them, with the margin or more.
std::vector<ContactPoint> find_listed_contacts(const ContactSurface& of_vertices,
                                               const NearDomains& near,
                                               const ContactSurface& of_domains,
                                               const Field& x,
                                               const Field& x_n,
                                               double margin);

}  // namespace sim
