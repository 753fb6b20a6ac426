// Trees of boxes around the domains of a body's shell, to find those that may hold vertices which are strangers to them.
#pragma once

#include "sim/contact/box_tree.h"
#include "sim/contact/contact_surface.h"

#include <bit>
#include <span>
#include <vector>

namespace sim {

/// Domains of the shell, and those of them that carry vertices, in an order in which near ones follow each other at rest;
/// where they are now is placed anew.
class ShellTree {
  public:
    /// `beyond`: the share of a domain that its map is continued. A stranger's centre is `apart` or more from a vertex at
    /// rest [m].
    ShellTree(const ContactSurface& surface, double beyond, double apart);

    /// Where the domains are, and the vertices that they carry, from values of the corners of the body (#corners), to be
    /// looked at within some distance.   [m]
    void place(const Field& corners, double within);

    /// Of eight domains that carry vertices.
    int n_groups() const { return vertices_.now.n_leaves(); }

    /// visit(v, x, q) for vertices v, at x, that domains of a group carry, and domains q of the shell that are strangers to
    /// them, where v is in the box of the continued q or no further from it than `within`, along its axes: for all of those,
    /// and others only by what single precision rounds.
    template <class Visit>
    void for_strangers(int group, const Visit& visit) const {
        descend(group, vertices_.around(group), domains_.now.n_levels() - 1, 0, visit);
    }

  private:
    static constexpr int n_lanes = EightBoxes::n;

    struct Boxes {
        FloatBox now, at_rest;  // [m]
    };

    struct Trees {
        BoxTree now, at_rest;  // [m]

        explicit Trees(std::size_t n) : now(n), at_rest(n) {}

        Boxes around(int leaf) const { return {now.around(0, leaf), at_rest.around(0, leaf)}; }
    };

    struct Carrier {
        int domain = 0;
        int begin = 0, end = 0;  // of its vertices, in carried_
        Boxes boxes;             // around them, as in vertices_
    };

    /// A bit for each child of a node that is near some boxes now, but not at rest.
    unsigned strangers(const Boxes& boxes, const Trees& trees, int level, int node) const {
        return trees.now.eight(level, node).met_by(boxes.now)
               & trees.at_rest.eight(level, node).parted_from(boxes.at_rest, apart_squared_);
    }

    template <class Visit>
    void descend(int group, const Boxes& all, int level, int node, const Visit& visit) const {
        const unsigned near = strangers(all, domains_, level, node);
        if (level == 0 && near != 0)
            return compare(group, node, visit);
        for (unsigned lanes = near; lanes != 0; lanes &= lanes - 1)
            descend(group, all, level - 1, n_lanes * node + std::countr_zero(lanes), visit);
    }

    template <class Visit>
    void compare(int group, int leaf, const Visit& visit) const {
        for (unsigned near = strangers(domains_.around(leaf), vertices_, 0, group); near != 0;
             near &= near - 1) {
            const Carrier& carrier = carriers_[n_lanes * group + std::countr_zero(near)];
            for (unsigned lanes = strangers(carrier.boxes, domains_, 0, leaf); lanes != 0;
                 lanes &= lanes - 1)
                compare(carrier, n_lanes * leaf + std::countr_zero(lanes), visit);
        }
    }

    template <class Visit>
    void compare(const Carrier& carrier, int k, const Visit& visit) const {
        const FloatBox box = domains_.now.box(k).widened(within_);
        for (int i = carrier.begin; i < carrier.end; ++i)
            if (box.holds(at_[i]) && is_stranger(carried_[i], shell_[k]))
                visit(carried_[i], at_[i], shell_[k]);
    }

    bool is_stranger(int vertex, int domain) const {
        return (surface_->vertices[vertex].rest - surface_->domain_centre(domain)).squaredNorm()
               >= apart_ * apart_;
    }

    void find_carriers();
    void place_domains(const Field& corners);
    void place_vertices(const Field& corners);
    std::array<Vec3p, 8> corners_of(int p, const Field& corners) const;
    /// Of a place now or at rest in single precision, at most.   [m]
    float rounding() const;

    const ContactSurface* surface_;
    double beyond_ = 0;
    double apart_ = 0;          // [m]
    float apart_squared_ = 0;   // in single precision, rounding allowed for [m²]
    float within_ = 0;          // the same [m]
    std::vector<int> shell_;    // (#shell) domains
    std::vector<int> carried_;  // (#vertices), carrier by carrier
    Field at_;                  // now [m]
    std::vector<Carrier> carriers_;
    // Around the continued domains of the shell, and their centres at rest; around the vertices of each carrier, now widened
    // by how near they are looked at.
    Trees domains_, vertices_;
};

}  // namespace sim
