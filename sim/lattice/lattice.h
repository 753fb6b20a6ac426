// A body cut into domains: equal cubes of edge s in rest space that share corners.
#pragma once

#include "assets/generators/solid.h"
#include "sim/lattice/part_blocks.h"
#include "sim/scene.h"

#include <array>
#include <string>
#include <vector>

namespace sim {

/// Corner a of a domain lies at (a & 1, a >> 1 & 1, a >> 2 & 1) of its cube. Domains and corners are sorted by
/// z, then y, then x of their integer coordinates.
///
/// A cube that holds several parts of the body that are not connected in it has a domain for each: they share the cell
/// but no corner, unless their neighbours connect them there. So two domains of neighbouring cells share the corners of
/// their common face only if material meets across it, and several corners may lie at one place.
struct Lattice {
    double edge = 0;       // s [m]
    Vec3 origin{0, 0, 0};  // rest position of the corner with coordinates (0,0,0) [m]

    // (#D) integer coordinates of each domain's lowest corner; not always unique.
    std::vector<std::array<int, 3>> cell;
    std::vector<std::array<int, 8>> corners;  // (#D) its corners
    // (#D) what fills it, over s³, > 0; above 1 with slivers (slivers.h).
    std::vector<double> fill;
    std::vector<Vec3> filled_centre;     // (#D) centroid of the filled part [m]
    std::vector<double> centre_outside;  // (#D) its signed distance from the body's surface [m]
    std::vector<int> region;             // (#D) region with the largest share
    // (#D) Lamé parameters of the filled part [Pa], share-weighted.
    std::vector<double> mu, lambda;
    std::vector<double> density;  // (#D) of the filled part [kg/m³], share-weighted
    std::vector<std::array<int, 3>> corner_cell;  // (#C) integer coordinates
    std::vector<Vec3> corner_rest;                // (#C) [m]
    std::vector<double> corner_mass;    // (#C) an eighth of each adjacent domain's mass [kg]
    std::vector<double> corner_volume;  // (#C) the same share of filled volume [m³]
    std::vector<double>
        corner_outside;  // (#C) distance outside the body's surface at rest; < 0 where a sliver
                         // reaches beyond a corner that has no domains all around [m]
    std::vector<int> part;          // (#D) index in parts; -1 where no other corner lies at
                                    // the place of one of the domain's
    std::vector<PartBlocks> parts;  // where in its cube a domain's material lies
    std::vector<double> region_volume, region_mass;  // (#regions) [m³], [kg]

    int n_domains() const { return static_cast<int>(cell.size()); }

    int n_corners() const { return static_cast<int>(corner_rest.size()); }

    double domain_volume(int p) const { return fill[p] * edge * edge * edge; }

    /// Of a domain's mixture.   [Pa]
    double young_modulus(int p) const {
        return mu[p] * (3 * lambda[p] + 2 * mu[p]) / (lambda[p] + mu[p]);
    }
};

/// What becomes of cubes that a body hardly touches (slivers.h). Points have no corners that could be loose.
enum class Slivers { Joined, Kept };

inline Slivers slivers_for(Method method) {
    return method == Method::Mpm ? Slivers::Kept : Slivers::Joined;
}

/// Voxelises a body. The lattice is aligned with the axes and placed so that a box whose edges are multiples of s is
/// cut exactly; otherwise it is centred on the body's bounds. Fill fractions and region shares come from regular
/// samples of the signed distance in cut domains. Throws Error(Input) with the key of a region that selects nothing,
/// or of a body that fills no domain.
Lattice make_lattice(const Body& body,
                     std::vector<std::string>* repairs = nullptr,
                     Slivers slivers = Slivers::Joined);

/// Squared distance from a point to what a domain carries: the nearest block of its part, or its cube.   [domain edges²]
/// `point` in lattice units, (X - origin) / s.
double squared_distance(const Lattice& lattice, int domain, const Vec3& point);

/// Corners of the part that `select` names: those whose rest position lies in it (within 1e-6 s, so that rounding
/// does not decide); of several corners at one place those with material in it, or all where none has. Throws Error(Input) with select.key where there are none.
std::vector<int> select_corners(const Lattice& lattice,
                                const Body& body,
                                const Selector& select);

/// λ = E nu / ((1+nu)(1-2nu)), μ = E / (2 (1+nu)).   [Pa]
double lame_lambda(double young_modulus, double poisson_ratio);
double lame_mu(double young_modulus, double poisson_ratio);

}  // namespace sim
