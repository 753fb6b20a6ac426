#include "sim/contact/fold_watch.h"

#include "sim/base/parallel.h"
#include "sim/contact/contact_search.h"
#include "sim/contact/domain_hull.h"
#include "sim/materials/signed_svd.h"

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

/// Seen from a frame that flies and turns with a body, it does not move when it does that alone.
struct FoldWatch::OwnFrame {
    Vec3p centre{};
    std::array<Vec3p, 3> column{};  // of the rotation into the frame

    /// The rotation is that of the polar decomposition of Σ x (X - X_mean)^T, `from_rest_centre` being X - X_mean.
    OwnFrame(const Field& x, int begin, const Field& from_rest_centre) {
        std::array<Vec3p, 3> sum{};
        for (std::size_t c = 0; c < from_rest_centre.size(); ++c) {
            const Vec3p at = x[begin + c];
            centre += at;
            for (int k = 0; k < 3; ++k)
                sum[k] += from_rest_centre[c][k] * at;
        }
        centre /= double(from_rest_centre.size());
        Mat3 covariance;
        covariance << unpadded(sum[0]), unpadded(sum[1]), unpadded(sum[2]);
        const auto [U, stretch, V] = signed_svd(covariance);
        const Mat3 inverse = V * U.transpose();
        for (int k = 0; k < 3; ++k)
            column[k] = padded(inverse.col(k));
    }

    Vec3p seen(const Vec3p& x) const {
        const Vec3p from_centre = x - centre;
        return from_centre[0] * column[0] + from_centre[1] * column[1]
               + from_centre[2] * column[2];
    }
};

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
        vertex_blocks_.push_back(std::move(block));
    for (auto& [cell, block] : domains)
        domain_blocks_.push_back(std::move(block));
    for (const std::vector<int>& block : vertex_blocks_)
        carriers_.push_back(carriers_of(block));

    Vec3 rest_centre = Vec3::Zero();
    for (const Vec3& X : lattice.corner_rest)
        rest_centre += X / lattice.n_corners();
    for (const Vec3& X : lattice.corner_rest)
        from_rest_centre_.push_back(padded(X - rest_centre));
}

std::vector<int> FoldWatch::carriers_of(const std::vector<int>& vertices) const {
    std::vector<int> corners;
    for (const int v : vertices)
        for (const int c : surface_->vertices[v].corners)
            corners.push_back(c - surface_->begin);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return corners;
}

double FoldWatch::see(const Field& x) {
    const OwnFrame frame(x, surface_->begin, from_rest_centre_);
    seen_.resize(from_rest_centre_.size());
    moved_.resize(seen_.size());
    followed_.resize(seen_.size());
    PaddedBounds all;
    for (std::size_t c = 0; c < seen_.size(); ++c) {
        seen_[c] = frame.seen(x[surface_->begin + c]);
        moved_[c] = seen_[c] - followed_[c];
        all.add(moved_[c]);
    }
    const double of_continued = std::pow(1 + 2 * beyond_domain, 3);
    return (of_vertex_ + of_continued) / 2 * all.farthest(all)
           + rounding * surface_->lattice->edge;
}

Vec3p FoldWatch::at_vertex(int v, const Field& values) const {
    const ContactVertex& vertex = surface_->vertices[v];
    Vec3p sum{};
    for (int a = 0; a < 8; ++a)
        sum += vertex.weights[a] * values[vertex.corners[a] - surface_->begin];
    return sum;
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

    std::vector<std::vector<BlockPair*>> used_up;  // by their domains
    for (BlockPair& pair : pairs_) {
        if (pair.change < pair.apart - least_left * edge)
            continue;
        if (used_up.empty() || used_up.back().front()->of_domains != pair.of_domains)
            used_up.emplace_back();
        used_up.back().push_back(&pair);
    }
    for_chunks(
        static_cast<int>(used_up.size()), 1, [&](int k, int /*end*/) { look_at(used_up[k]); });

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
        for (const int c : carriers_[a])
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
    std::vector<PaddedBounds> of_vertices(vertex_blocks_.size()), of_domains;
    for (std::size_t a = 0; a < of_vertices.size(); ++a)
        for (const int v : vertex_blocks_[a])
            of_vertices[a].add(at_vertex(v, seen_));
    for (const std::vector<int>& block : domain_blocks_)
        of_domains.push_back(of_continued(block, seen_));
    // Both lists are in the same order; what is known of a pair stays.
    std::vector<BlockPair> pairs;
    auto old = pairs_.begin();
    for (int b = 0; b < static_cast<int>(of_domains.size()); ++b)
        for (int a = 0; a < static_cast<int>(of_vertices.size()); ++a) {
            const bool is_known =
                old != pairs_.end() && old->of_domains == b && old->of_vertices == a;
            const double gap = of_vertices[a].gap(of_domains[b]);
            if (gap < far * surface_->lattice->edge)
                pairs.push_back(is_known ? std::move(*old) : BlockPair{a, b, {}, gap});
            old += is_known;
        }
    pairs_ = std::move(pairs);
    unlisted_change_ = 0;
}

void FoldWatch::look_at(const std::vector<BlockPair*>& pairs) const {
    const double edge = surface_->lattice->edge, stranger = neighbourhood * edge;
    const std::vector<int>& domains = domain_blocks_[pairs.front()->of_domains];
    std::vector<std::array<Vec3p, 8>> corners;
    std::vector<PaddedBounds> bounds;
    PaddedBounds all;
    for (const int p : domains) {
        corners.push_back(at_continued(p, seen_));
        bounds.push_back(bounds_of(corners.back()));
        all.add(bounds.back());
    }
    Field vertices;
    for (BlockPair* pair : pairs) {
        const std::vector<int>& block = vertex_blocks_[pair->of_vertices];
        vertices.clear();
        for (const int v : block)
            vertices.push_back(at_vertex(v, seen_));
        const PaddedBounds around = bounds_of(vertices);
        *pair = {
            pair->of_vertices, pair->of_domains, {}, std::max(watched * edge, all.gap(around))};
        for (std::size_t d = 0; d < domains.size(); ++d) {
            if (bounds[d].gap(around) >= pair->apart)
                continue;
            const Vec3 rest_centre = surface_->domain_centre(domains[d]);
            std::optional<Hull> hull;
            for (std::size_t k = 0; k < block.size(); ++k) {
                if (bounds[d].gap({vertices[k], vertices[k]}) >= pair->apart
                    || (surface_->vertices[block[k]].rest - rest_centre).squaredNorm()
                           < stranger * stranger)
                    continue;
                if (!hull)
                    hull.emplace(corners[d]);
                const double gap = hull->gap(vertices[k]);
                if (gap < pair->apart)
                    pair->near.push_back({block[k], domains[d], gap});
            }
        }
    }
}

std::vector<int> FoldWatch::strangers(const Field& x) {
    double change = see(x);
    if (!(change < left_)) {
        follow();
        change = 0;
    }
    std::vector<int> found;
    for (const Near& near : nearest_)
        if (near.gap <= change
            && Hull(at_continued(near.domain, seen_)).holds(at_vertex(near.vertex, seen_)))
            found.push_back(near.vertex);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace sim
