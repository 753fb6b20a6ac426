#include "sim/contact/fold_watch.h"

#include "sim/base/parallel.h"
#include "sim/contact/domain_hull.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sim {

namespace {

constexpr double beyond_domain = 0.25;  // that strangers are continued, in their edges
constexpr double watched = 0.65;        // gaps of vertices that are listed, in domain edges
constexpr double half_box = 0.5 + beyond_domain + watched;
static_assert(3 * half_box * half_box < neighbourhood * neighbourhood,
              "else boxes meet at rest that strangers are looked for in");
constexpr int chunk = 8;  // of leaves

}  // namespace

FoldWatch::FoldWatch(const ContactSurface& surface)
    : surface_(&surface), tree_(surface, beyond_domain, neighbourhood * surface.lattice->edge) {
    const Lattice& lattice = *surface.lattice;
    const double of_continued = std::pow(1 + 2 * beyond_domain, 3);
    of_strain_ = (surface.largest_weight_sum - 1) / 2 + (of_continued - 1) / 2;

    Vec3 rest_centre = Vec3::Zero();
    for (const Vec3& X : lattice.corner_rest)
        rest_centre += X / lattice.n_corners();
    for (const Vec3& X : lattice.corner_rest)
        from_rest_centre_.push_back(padded(X - rest_centre));
    for (Field* field : {&x_seen_, &seen_, &looked_at_})
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
           + (1 + of_strain_)
                 * (moved.farthest(moved) + now_.turn_from(frame_seen_) * wide_seen_)
           + LookAhead::rounding * surface_->lattice->edge;
}

double FoldWatch::see(const Field& x) {
    PaddedBounds moved, all;
    for (std::size_t c = 0; c < seen_.size(); ++c) {
        x_seen_[c] = x[surface_->begin + c];
        seen_[c] = now_.seen(x_seen_[c]);
        moved.add(seen_[c] - looked_at_[c]);
        all.add(seen_[c]);
    }
    frame_seen_ = now_;
    wide_seen_ = all.farthest(all);
    return moved.farthest(moved) + of_strain_ * most_strained()
           + LookAhead::rounding * surface_->lattice->edge;
}

double FoldWatch::most_strained() const {
    double squared = 0;
    for (const int p : surface_->shell) {
        PaddedBounds moved;
        for (const int c : surface_->lattice->corners[p])
            moved.add(seen_[c] - looked_at_[c]);
        const Vec3p apart = moved.high - moved.low;
        squared = std::max(squared, dot(apart, apart));
    }
    return std::sqrt(squared);
}

void FoldWatch::look(double within) {
    tree_.place(seen_, within);
    const int n = tree_.n_groups();
    std::vector<std::vector<Near>> parts((n + chunk - 1) / chunk);
    for_chunks(n, chunk, [&](int begin, int end) {
        for (int group = begin; group < end; ++group)
            look_at(group, within, parts[begin / chunk]);
    });
    nearest_.clear();
    for (const std::vector<Near>& part : parts)
        nearest_.insert(nearest_.end(), part.begin(), part.end());
    looked_at_ = seen_;
}

void FoldWatch::look_at(int group, double within, std::vector<Near>& near) const {
    std::optional<Hull> hull;
    int of_hull = -1;
    tree_.for_strangers(group, [&](int v, const Vec3p& x, int q) {
        if (q != of_hull) {
            std::array<Vec3p, 8> corners;
            for (int a = 0; a < 8; ++a)
                corners[a] = seen_[surface_->lattice->corners[q][a]];
            go_beyond(beyond_domain, corners);
            hull.emplace(corners);
            of_hull = q;
        }
        const double gap = hull->gap(x);
        if (gap <= within)
            near.push_back({v, q, gap});
    });
}

bool FoldWatch::is_in(const Near& near, const Field& x) const {
    std::array<Vec3p, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] = now_.seen(x[surface_->begin + surface_->lattice->corners[near.domain][a]]);
    go_beyond(beyond_domain, corners);
    const ContactVertex& vertex = surface_->vertices[near.vertex];
    Vec3p at{};
    for (int a = 0; a < 8; ++a)
        at += vertex.weights[a] * now_.seen(x[vertex.corners[a]]);
    return Hull(corners).holds(at);
}

std::vector<int> FoldWatch::strangers(const Field& x) {
    ahead_.count();
    double change = change_at_most(x);
    if (!ahead_.stands(change))
        change = change_seen_ = see(x);
    if (!ahead_.stands(change)) {
        look(ahead_.renew(change, watched * surface_->lattice->edge));
        change = change_seen_ = 0;
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
