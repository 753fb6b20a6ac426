#include "sim/contact/fold_watch.h"

#include "sim/base/parallel.h"
#include "sim/contact/contact_search.h"
#include "sim/contact/domain_hull.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace sim {

namespace {

constexpr int vertex_block = 3, domain_block = 4;  // edges of blocks, in domain edges
constexpr double watched = 0.9;     // gaps of vertices that are kept, in domain edges
constexpr double far = 4;           // gaps of blocks that are kept, in domain edges
constexpr double least_left = 0.2;  // of a gap before it is looked at again, in domain edges
constexpr double rounding = 1e-9;   // of distances, in domain edges

template <class Points>
PaddedBounds bounds_of(const Points& points) {
    PaddedBounds bounds;
    for (const Vec3p& x : points)
        bounds.add(x);
    return bounds;
}

using Blocks = std::map<std::array<int, 3>, std::vector<int>>;

std::array<int, 3> block_of(std::array<int, 3> cell, int edge) {
    for (int& index : cell)
        index = static_cast<int>(std::floor(double(index) / edge));
    return cell;
}

}  // namespace

FoldWatch::FoldWatch(const ContactSurface& surface) : surface_(&surface) {
    const Lattice& lattice = *surface.lattice;
    Blocks vertices, domains;
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
        const ContactVertex& vertex = surface.vertices[v];
        double sum = 0;
        for (const double w : vertex.weights)
            sum += std::abs(w);
        of_vertex_ = std::max(of_vertex_, sum);
        const int lowest = vertex.corners[0] - surface.begin;
        vertices[block_of(lattice.corner_cell[lowest], vertex_block)].push_back(int(v));
    }
    for (const int p : surface.shell)
        domains[block_of(lattice.cell[p], domain_block)].push_back(p);
    for (auto& [cell, block] : vertices)
        vertex_blocks_.emplace_back(surface, std::move(block));
    for (auto& [cell, block] : domains)
        domain_blocks_.push_back(std::move(block));

    Vec3 rest_centre = Vec3::Zero();
    for (const Vec3& X : lattice.corner_rest)
        rest_centre += X / lattice.n_corners();
    for (const Vec3& X : lattice.corner_rest)
        from_rest_centre_.push_back(padded(X - rest_centre));
    const double of_continued = std::pow(1 + 2 * beyond_domain, 3);
    of_gaps_ = (of_vertex_ + of_continued) / 2;
    for (Field* field : {&x_seen_, &seen_, &followed_, &moved_})
        field->assign(from_rest_centre_.size(), Vec3p{});
}

double FoldWatch::change_at_most(const Field& x) {
    FrameSums sums;
    PaddedBounds moved;
    for (std::size_t c = 0; c < from_rest_centre_.size(); ++c) {
        const Vec3p at = x[surface_->begin + c];
        sums.add(at, from_rest_centre_[c]);
        moved.add(at - x_seen_[c]);
    }
    now_ = sums.frame(from_rest_centre_.size());
    // Rᵀ a with a between two corners: the change of a, and the turn of what it was.
    return change_seen_
           + of_gaps_ * (moved.farthest(moved) + now_.turn_from(frame_seen_) * wide_seen_)
           + rounding * surface_->lattice->edge;
}

double FoldWatch::see(const Field& x) {
    PaddedBounds moved, all;
    for (std::size_t c = 0; c < seen_.size(); ++c) {
        x_seen_[c] = x[surface_->begin + c];
        seen_[c] = now_.seen(x_seen_[c]);
        moved_[c] = seen_[c] - followed_[c];
        moved.add(moved_[c]);
        all.add(seen_[c]);
    }
    frame_seen_ = now_;
    wide_seen_ = all.farthest(all);
    return of_gaps_ * moved.farthest(moved) + rounding * surface_->lattice->edge;
}

std::array<Vec3p, 8> FoldWatch::at_continued(int p, const Field& values) const {
    std::array<Vec3p, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] = values[surface_->lattice->corners[p][a]];
    go_beyond(corners);
    return corners;
}

PaddedBounds FoldWatch::of_continued(const std::vector<int>& domains,
                                     const Field& values) const {
    PaddedBounds bounds;
    for (const int p : domains)
        for (const Vec3p& value : at_continued(p, values))
            bounds.add(value);
    return bounds;
}

void FoldWatch::follow() {
    const double edge = surface_->lattice->edge;
    if (pairs_.empty())
        list_pairs();
    else
        add_changes();
    if (!(unlisted_change_ < (far - least_left) * edge))
        list_pairs();

    look_at_used_up();
    followed_ = seen_;
    left_ = far * edge - unlisted_change_;
    for (const BlockPair& pair : pairs_)
        left_ = std::min(left_, pair.apart - pair.change);
    nearest_.clear();
    for (const BlockPair& pair : pairs_)
        for (const Near& near : pair.near)
            if (near.gap - pair.change <= left_)
                nearest_.push_back({near.vertex, near.domain, near.gap - pair.change});
}

void FoldWatch::add_changes() {
    std::vector<PaddedBounds> of_vertices(vertex_blocks_.size()),
        of_domains(domain_blocks_.size());
    PaddedBounds all;
    for (std::size_t a = 0; a < of_vertices.size(); ++a) {
        for (const int c : vertex_blocks_[a].carriers)
            of_vertices[a].add(moved_[c]);
        all.add(of_vertices[a]);
    }
    for_chunks(static_cast<int>(of_domains.size()), 4, [&](int begin, int end) {
        for (int b = begin; b < end; ++b)
            of_domains[b] = of_continued(domain_blocks_[b], moved_);
    });
    for (const PaddedBounds& bounds : of_domains)
        all.add(bounds);
    // A hull ends at corners of continued domains; a vertex moves, seen from one of them, with corners around it.
    const double rounded = rounding * surface_->lattice->edge;
    unlisted_change_ += of_vertex_ * all.farthest(all) + rounded;
    for (BlockPair& pair : pairs_)
        pair.change +=
            of_vertex_ * of_vertices[pair.of_vertices].farthest(of_domains[pair.of_domains])
            + rounded;
}

void FoldWatch::list_pairs() {
    std::vector<PaddedBounds> of_domains;
    for (VertexBlock& block : vertex_blocks_)
        block.place(*surface_, seen_);
    for (const std::vector<int>& block : domain_blocks_)
        of_domains.push_back(of_continued(block, seen_));
    // Both lists are in the same order; what is known of a pair stays.
    std::vector<BlockPair> pairs;
    auto old = pairs_.begin();
    for (int b = 0; b < static_cast<int>(of_domains.size()); ++b)
        for (int a = 0; a < static_cast<int>(vertex_blocks_.size()); ++a) {
            const bool is_known =
                old != pairs_.end() && old->of_domains == b && old->of_vertices == a;
            const double gap = vertex_blocks_[a].bounds.gap(of_domains[b]);
            if (gap < far * surface_->lattice->edge)
                pairs.push_back(is_known ? std::move(*old) : BlockPair{a, b, {}, gap});
            old += is_known;
        }
    pairs_ = std::move(pairs);
    unlisted_change_ = 0;
}

void FoldWatch::look_at_used_up() {
    const double edge = surface_->lattice->edge;
    std::vector<std::vector<BlockPair*>> used_up;  // by their domains
    std::vector<char> is_looked_at(vertex_blocks_.size(), 0);
    for (BlockPair& pair : pairs_) {
        if (pair.change < pair.apart - least_left * edge)
            continue;
        if (used_up.empty() || used_up.back().front()->of_domains != pair.of_domains)
            used_up.emplace_back();
        used_up.back().push_back(&pair);
        is_looked_at[pair.of_vertices] = 1;
    }
    for_chunks(static_cast<int>(vertex_blocks_.size()), 4, [&](int begin, int end) {
        for (int a = begin; a < end; ++a)
            if (is_looked_at[a])
                vertex_blocks_[a].place(*surface_, seen_);
    });
    for_chunks(
        static_cast<int>(used_up.size()), 1, [&](int k, int /*end*/) { look_at(used_up[k]); });
}

void FoldWatch::look_at(const std::vector<BlockPair*>& pairs) const {
    const double edge = surface_->lattice->edge, stranger = neighbourhood * edge;
    const std::vector<int>& domains = domain_blocks_[pairs.front()->of_domains];
    std::vector<std::array<Vec3p, 8>> corners;
    std::vector<PaddedBounds> bounds;
    std::vector<Vec3> centres;  // at rest
    PaddedBounds all;
    for (const int p : domains) {
        centres.push_back(surface_->domain_centre(p));
        corners.push_back(at_continued(p, seen_));
        bounds.push_back(bounds_of(corners.back()));
        all.add(bounds.back());
    }
    std::vector<std::optional<Hull>> hulls(domains.size());
    for (BlockPair* pair : pairs) {
        const VertexBlock& block = vertex_blocks_[pair->of_vertices];
        pair->near.clear();
        pair->apart = std::max(watched * edge, all.gap(block.bounds));
        pair->change = 0;
        for (std::size_t d = 0; d < domains.size(); ++d) {
            if (bounds[d].gap(block.bounds) >= pair->apart)
                continue;
            const Vec3& centre = centres[d];
            block.for_strangers_near(bounds[d], pair->apart, centre, stranger, [&](int k) {
                const int v = block.vertices[k];
                if ((surface_->vertices[v].rest - centre).squaredNorm() < stranger * stranger)
                    return;
                if (!hulls[d])
                    hulls[d].emplace(corners[d]);
                const double gap = hulls[d]->gap(block.at(k));
                if (gap < pair->apart)
                    pair->near.push_back({v, domains[d], gap});
            });
        }
    }
}

bool FoldWatch::is_in(const Near& near, const Field& x) const {
    std::array<Vec3p, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] = now_.seen(x[surface_->begin + surface_->lattice->corners[near.domain][a]]);
    go_beyond(corners);
    const ContactVertex& vertex = surface_->vertices[near.vertex];
    Vec3p at{};
    for (int a = 0; a < 8; ++a)
        at += vertex.weights[a] * now_.seen(x[vertex.corners[a]]);
    return Hull(corners).holds(at);
}

std::vector<int> FoldWatch::strangers(const Field& x) {
    double change = change_at_most(x);
    if (!(change < left_)) {
        change = change_seen_ = see(x);
        if (!(change < left_)) {
            follow();
            change = change_seen_ = 0;
        }
    }
    std::vector<int> found;
    for (const Near& near : nearest_)
        if (near.gap <= change && is_in(near, x))
            found.push_back(near.vertex);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace sim
