#include "sim/contact/contact_search.h"

#include "sim/base/floor.h"
#include "sim/base/parallel.h"
#include "sim/contact/domain_hull.h"
#include "sim/contact/domain_map.h"
#include "sim/embedding/trilinear.h"

#include <cmath>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int vertex_chunk = 256;
constexpr int bisections = 6;  // of the way into a body
// Of the distance; where it is less, in the middle of a body, no side is nearer.
constexpr double least_gradient = 0.1;
// Beyond a domain where rounding may put what is in its neighbour, in domain edges.
constexpr double seam = 1e-3;

/// A deformed domain. The gradient at its centre, of the map from its cube to the world, solves for the linear part of the way
/// back.
struct Candidate {
    int domain = 0;
    Ball ball;  // of what it is continued to
    DomainMap map;
    PaddedMatrix at_centre;
    double bend = 0;  // DomainMap::bend, as far as it is continued
};

/// Where a point is in a body.
struct Place {
    int domain = -1;
    Vec3p u{};                  // of the domain's map
    double outside = infinity;  // of the domain
    const DomainMap* map = nullptr;
};

/// A piece of a body's surface at rest, seen from a rest point: how far outside, and its gradient.
struct Plane {
    double gap = 0;
    Vec3 normal{0, 0, 0};
};

double outside_of_cube(const Vec3p& u) {
    return std::max(0.0, largest_entry(magnitude(u)) - 0.5);
}

class Search {
  public:
    Search(const ContactSurface& of_vertices,
           const NearDomains& near,
           const ContactSurface& of_domains,
           const Field& x,
           const Field& x_n,
           double margin)
        : a_(of_vertices),
          near_(near),
          b_(of_domains),
          x_(x),
          x_n_(x_n),
          margin_(margin),
          beyond_(margin / of_domains.lattice->edge) {
        for (const int p : near.domains)
            candidates_.push_back(candidate(p));
    }

    std::vector<ContactPoint> run() const {
        // Vertices in chunks of a fixed size, their contacts in order.
        const int n = static_cast<int>(near_.vertices.size());
        std::vector<std::vector<ContactPoint>> parts((n + vertex_chunk - 1) / vertex_chunk);
        for_chunks(n, vertex_chunk, [&](int begin, int end) {
            for (int k = begin; k < end; ++k)
                look_at(k, parts[begin / vertex_chunk]);
        });
        std::vector<ContactPoint> found;
        for (const std::vector<ContactPoint>& part : parts)
            found.insert(found.end(), part.begin(), part.end());
        return found;
    }

  private:
    Candidate candidate(int p) const {
        std::array<Vec3p, 8> corners = b_.domain_corners(p, x_);
        const DomainMap map(corners);
        const PaddedMatrix at_centre = map.gradient_at_centre();
        go_beyond(beyond_, corners);
        return {p, Ball(corners), map, at_centre, map.bend(at_centre, 0.5 + beyond_)};
    }

    void look_at(int k, std::vector<ContactPoint>& found) const {
        const ContactVertex& vertex = a_.vertices[near_.vertices[k]];
        const Place place = locate(vertex, vertex.padded_position(x_), near_.of_vertex(k));
        ContactPoint contact;
        if (place.domain >= 0 && linearize_gap(vertex, place, contact)
            && contact.gap <= margin_)
            found.push_back(contact);
    }

    Place locate(const ContactVertex& vertex,
                 const Vec3p& point,
                 std::span<const int> nearby) const {
        Place best;
        for (const int i : nearby) {
            const Candidate& candidate = candidates_[i];
            if (!candidate.ball.holds(point) || !(candidate.at_centre.determinant > 0))
                continue;
            Vec3p u = candidate.at_centre.solve(point - candidate.map.centre());
            if (outside_of_cube(u) > std::min(beyond_, best.outside) + candidate.bend
                || is_neighbour(vertex, candidate.domain)
                || is_in_another(candidate.domain, u, candidate.bend)
                || !candidate.map.invert(point, u))
                continue;
            const double outside = outside_of_cube(u);
            if (outside > beyond_ || outside >= best.outside
                || is_in_another(candidate.domain, u, 0))
                continue;
            best = {candidate.domain, u, outside, &candidate.map};
            if (outside == 0)
                break;  // of those that hold it, the first
        }
        return best;
    }

    bool is_neighbour(const ContactVertex& vertex, int domain) const {
        const double least = neighbourhood * b_.lattice->edge;
        return &a_ == &b_
               && (b_.domain_centre(domain) - vertex.rest).squaredNorm() < least * least;
    }

    /// Whether the rest point that the map of one domain gives lies in another, as far as u, known up to `error`, tells.
    bool is_in_another(int domain, const Vec3p& u, double error) const {
        if (!(outside_of_cube(u) > seam + error))
            return false;
        const Vec3p low = floor_of(u + (0.5 - error)), high = floor_of(u + (0.5 + error));
        std::array<int, 3> cell = b_.lattice->cell[domain];
        for (int k = 0; k < 3; ++k) {
            if (low[k] != high[k])
                return false;
            cell[k] += static_cast<int>(low[k]);
        }
        const int there = b_.cells.find(cell);
        return there >= 0 && there != domain;
    }

    Vec3 rest_point(int domain, const Vec3p& u) const {
        return b_.domain_centre(domain) + b_.lattice->edge * unpadded(u);
    }

    /// The plane of the surface that a rest point has met: the nearest, or, of one that comes from outside, where its way
    /// from where it was at the start of the step goes in. Near an edge the nearest may be a side that it never passed.
    Plane met_plane(const ContactVertex& vertex, const Place& place, const Vec3& X) const {
        Plane plane = plane_at(X);
        Vec3p u = place.u;
        if (plane.gap >= 0
            || !DomainMap(b_.domain_corners(place.domain, x_n_))
                    .invert(vertex.padded_position(x_n_), u))
            return plane;
        Vec3 outside = rest_point(place.domain, u), inside = X;
        if (plane_at(outside).gap < 0)
            return plane;
        for (int k = 0; k < bisections; ++k) {
            const Vec3 middle = (outside + inside) / 2;
            (plane_at(middle).gap < 0 ? inside : outside) = middle;
        }
        plane = plane_at(inside);
        plane.gap += plane.normal.dot(X - inside);
        return plane;
    }

    /// Along the surface's outer normal at a vertex today, F^-T grad phi. Where a body is crushed, a vertex also nears
    /// places of its own side: only what faces it can be met.
    Vec3 outward(const ContactVertex& vertex) const {
        std::array<Vec3p, 8> at;
        for (int a = 0; a < 8; ++a)
            at[a] = x_[vertex.corners[a]];
        const Vec3 u = local_coordinates(vertex.weights) - Vec3::Constant(0.5);
        Vec3 gradient;
        a_.distance.at(vertex.rest, gradient);
        return unpadded(DomainMap(at).gradient(padded(u)).solve_transposed(padded(gradient)));
    }

    Plane plane_at(const Vec3& X) const {
        Plane plane;
        plane.gap = b_.distance.at(X, plane.normal);
        return plane;
    }

    bool linearize_gap(const ContactVertex& vertex,
                       const Place& place,
                       ContactPoint& contact) const {
        const Plane plane = met_plane(vertex, place, rest_point(place.domain, place.u));
        const double edge = b_.lattice->edge;
        const PaddedMatrix gradient = place.map->gradient(place.u);  // edge F
        if (!(gradient.determinant > 0) || !(plane.normal.norm() > least_gradient))
            return false;
        const Vec3 n =
            edge * unpadded(gradient.solve_transposed(padded(plane.normal.normalized())));
        contact.vertex = &vertex;
        contact.gap = plane.gap / n.norm();
        contact.normal = n.normalized();
        if (&a_ == &b_ && contact.normal.dot(outward(vertex)) > 0)
            return false;
        contact.weights = trilinear_weights(unpadded(place.u) + Vec3::Constant(0.5));
        contact.edge = edge;
        for (int a = 0; a < 8; ++a)
            contact.corners[a] = b_.begin + b_.lattice->corners[place.domain][a];
        return true;
    }

    const ContactSurface& a_;
    const NearDomains& near_;
    const ContactSurface& b_;
    const Field &x_, &x_n_;
    double margin_ = 0;
    double beyond_ = 0;                  // a domain that its map is continued, in domain edges
    std::vector<Candidate> candidates_;  // of near_.domains
};

}  // namespace

std::vector<ContactPoint> find_contacts(const ContactSurface& of_vertices,
                                        std::span<const int> vertices,
                                        const ContactSurface& of_domains,
                                        const Field& x,
                                        const Field& x_n,
                                        double margin) {
    const double beyond = margin / of_domains.lattice->edge;
    return find_listed_contacts(of_vertices,
                                near_domains(of_vertices, vertices, of_domains, x, beyond, 0),
                                of_domains,
                                x,
                                x_n,
                                margin);
}

std::vector<ContactPoint> find_listed_contacts(const ContactSurface& of_vertices,
                                               const NearDomains& near,
                                               const ContactSurface& of_domains,
                                               const Field& x,
                                               const Field& x_n,
                                               double margin) {
    return Search(of_vertices, near, of_domains, x, x_n, margin).run();
}

}  // namespace sim
