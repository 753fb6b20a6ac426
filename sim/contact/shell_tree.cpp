#include "sim/contact/shell_tree.h"

#include "sim/base/parallel.h"
#include "sim/contact/domain_hull.h"

#include <algorithm>
#include <cstdint>

namespace sim {

namespace {

constexpr int chunk = 8 * EightBoxes::n;    // of domains: no two threads set boxes of a leaf
constexpr float single_rounding = 0x1p-21;  // a few roundings of single precision

/// Bits of three coordinates in turn [Mor66]: what is near in this order is near in space.
std::uint64_t morton_code(const std::array<int, 3>& cell) {
    std::uint64_t code = 0;
    for (int bit = 0; bit < 21; ++bit)
        for (int axis = 0; axis < 3; ++axis)
            code |= std::uint64_t(cell[axis] >> bit & 1) << (3 * bit + axis);
    return code;
}

}  // namespace

ShellTree::ShellTree(const ContactSurface& surface, double beyond, double apart)
    : surface_(&surface),
      beyond_(beyond),
      apart_(apart),
      shell_(surface.shell),
      domains_(shell_.size()),
      vertices_(0) {
    const Lattice& lattice = *surface.lattice;
    std::sort(shell_.begin(), shell_.end(), [&](int p, int q) {
        return std::pair(morton_code(lattice.cell[p]), p)
               < std::pair(morton_code(lattice.cell[q]), q);
    });
    for (std::size_t k = 0; k < shell_.size(); ++k) {
        const Vec3p centre = padded(surface.domain_centre(shell_[k]) - lattice.origin);
        domains_.at_rest.set(k, FloatBox({centre, centre}));
    }
    domains_.at_rest.carry_up();
    find_carriers();
    const float least = static_cast<float>(apart) - rounding();
    apart_squared_ = least * least;
}

void ShellTree::find_carriers() {
    const std::vector<ContactVertex>& vertices = surface_->vertices;
    std::vector<int> place(surface_->lattice->n_domains(), -1);
    for (std::size_t k = 0; k < shell_.size(); ++k)
        place[shell_[k]] = static_cast<int>(k);
    carried_ = surface_->all_vertices();
    std::stable_sort(carried_.begin(), carried_.end(), [&](int v, int w) {
        return place[vertices[v].domain] < place[vertices[w].domain];
    });
    at_.resize(carried_.size());
    std::vector<PaddedBounds> at_rest;
    for (int i = 0; i < static_cast<int>(carried_.size()); ++i) {
        const ContactVertex& vertex = vertices[carried_[i]];
        if (carriers_.empty() || carriers_.back().domain != vertex.domain) {
            carriers_.push_back({vertex.domain, i, i, {}});
            at_rest.emplace_back();
        }
        carriers_.back().end = i + 1;
        at_rest.back().add(padded(vertex.rest - surface_->lattice->origin));
    }
    vertices_ = Trees(carriers_.size());
    for (std::size_t k = 0; k < carriers_.size(); ++k) {
        carriers_[k].boxes.at_rest = FloatBox(at_rest[k]);
        vertices_.at_rest.set(k, carriers_[k].boxes.at_rest);
    }
    vertices_.at_rest.carry_up();
}

float ShellTree::rounding() const {
    const FloatBox &now = domains_.now.around(), &rest = domains_.at_rest.around();
    float extent = static_cast<float>(surface_->lattice->edge);
    for (int axis = 0; axis < 3; ++axis)
        extent = std::max(
            {extent, now.high[axis], -now.low[axis], rest.high[axis], -rest.low[axis]});
    return single_rounding * extent;
}

std::array<Vec3p, 8> ShellTree::corners_of(int p, const Field& corners) const {
    std::array<Vec3p, 8> at;
#pragma GCC unroll 8
    for (int a = 0; a < 8; ++a)
        at[a] = corners[surface_->lattice->corners[p][a]];
    return at;
}

void ShellTree::place(const Field& corners, double within) {
    place_domains(corners);
    within_ = static_cast<float>(within) + rounding();
    place_vertices(corners);
}

void ShellTree::place_domains(const Field& corners) {
    for_chunks(static_cast<int>(shell_.size()), chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            std::array<Vec3p, 8> at = corners_of(shell_[k], corners);
            go_beyond(beyond_, at);
            PaddedBounds bounds;
#pragma GCC unroll 8
            for (int a = 0; a < 8; ++a)
                bounds.add(at[a]);
            domains_.now.set(k, FloatBox(bounds));
        }
    });
    domains_.now.carry_up();
}

void ShellTree::place_vertices(const Field& corners) {
    for_chunks(static_cast<int>(carriers_.size()), chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            Carrier& carrier = carriers_[k];
            const std::array<Vec3p, 8> of_domain = corners_of(carrier.domain, corners);
            PaddedBounds bounds;
            for (int i = carrier.begin; i < carrier.end; ++i) {
                const std::array<double, 8>& w = surface_->vertices[carried_[i]].weights;
                at_[i] = Vec3p{};
#pragma GCC unroll 8
                for (int a = 0; a < 8; ++a)
                    at_[i] += w[a] * of_domain[a];
                bounds.add(at_[i]);
            }
            carrier.boxes.now = FloatBox(bounds).widened(within_);
            vertices_.now.set(k, carrier.boxes.now);
        }
    });
    vertices_.now.carry_up();
}

}  // namespace sim
