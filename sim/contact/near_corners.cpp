#include "sim/contact/near_corners.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double share_left = 0.3;  // of the least gap of far corners, before all are looked at
constexpr double steps_ahead = 12;  // that near ones are listed for, as fast as lately

/// How far a point in `bounds` goes, at most, as a collider sees it that goes from one pose to the other.   [m]
double way_seen(const Pose& from, const Pose& to, const PaddedBounds& bounds) {
    // Linear in the point, so the longest is that of a corner.
    double longest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 x;
        for (int axis = 0; axis < 3; ++axis)
            x[axis] = (corner >> axis & 1 ? bounds.high : bounds.low)[axis];
        longest = std::max(longest, (to.bring_back(x) - from.bring_back(x)).norm());
    }
    return longest;
}

}  // namespace

NearCorners::NearCorners(std::vector<int> corners, std::size_t n_colliders, double margin)
    : corners_(std::move(corners)),
      all_(corners_.size()),
      margin_(margin),
      looked_at_(corners_.size()),
      far_(n_colliders) {
    std::iota(all_.begin(), all_.end(), 0);
    near_ = all_;
}

double NearCorners::way_since_look(const Field& x) const {
    return farthest([&](int k) { return x[corners_[k]] - looked_at_[k]; });
}

double NearCorners::least_gap(int j, double way, const Pose& pose) const {
    return far_[j].gap - steepest_distance * (way + way_seen(far_[j].pose, pose, bounds_));
}

bool NearCorners::stands(double way, const std::vector<Pose>& poses) const {
    for (int j = 0; j < static_cast<int>(far_.size()); ++j)
        if (!(least_gap(j, way, poses[j]) > share_left * far_[j].gap))
            return false;
    return true;
}

void NearCorners::begin_step(const Field& x,
                             double gone,
                             const std::vector<Pose>& from,
                             const std::vector<Pose>& to,
                             const Gap& gap) {
    way_ += gone;
    if (!stands(way_, from))
        way_ = way_since_look(x);
    if (!stands(way_, from)) {
        look(x, way_, from, gap);
        way_ = 0;
    }
    ++n_steps_;
    free_way_ = infinity;
    for (int j = 0; j < static_cast<int>(far_.size()); ++j)
        free_way_ = std::min(free_way_,
                             least_gap(j, way_, from[j]) / steepest_distance
                                 - way_seen(from[j], to[j], bounds_.widened(way_)));
}

void NearCorners::look(const Field& x,
                       double way,
                       const std::vector<Pose>& poses,
                       const Gap& gap) {
    const int n_colliders = static_cast<int>(far_.size());
    const double ahead = n_steps_ > 0 ? steepest_distance * steps_ahead / n_steps_ : 0;
    std::vector<double> margins, gaps(far_.size());
    for (int j = 0; j < n_colliders; ++j) {
        margins.push_back(
            std::max(margin_, ahead * (way + way_seen(far_[j].pose, poses[j], bounds_))));
        far_[j] = {infinity, poses[j]};
    }
    near_.clear();
    bounds_ = {};
    for (const int k : all_) {
        looked_at_[k] = x[corners_[k]];
        bounds_.add(looked_at_[k]);
        bool is_near = false;
        for (int j = 0; j < n_colliders; ++j) {
            gaps[j] = gap(k, j, poses[j].bring_back(unpadded(looked_at_[k])));
            is_near = is_near || gaps[j] < margins[j];
        }
        if (is_near)
            near_.push_back(k);
        else
            for (int j = 0; j < n_colliders; ++j)
                far_[j].gap = std::min(far_[j].gap, gaps[j]);
    }
    // Where none is far, all are looked at again once they may have left.
    for (int j = 0; j < n_colliders; ++j)
        far_[j].gap = std::isinf(far_[j].gap) ? margins[j] : far_[j].gap;
    n_steps_ = 0;
}

const std::vector<int>& NearCorners::reaching(
    int j, const Field& x, const Field& v, double dt, const Pose& from, const Pose& to) const {
    const double way = way_since_look(x);
    const double reach = farthest([&](int k) { return dt * v[corners_[k]]; })
                         + way_seen(from, to, bounds_.widened(way));
    return least_gap(j, way, from) > reach ? near_ : all_;
}

}  // namespace sim
