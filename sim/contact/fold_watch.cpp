#include "sim/contact/fold_watch.h"

#include "sim/base/parallel.h"
#include "sim/contact/contact_search.h"
#include "sim/contact/point_grid.h"

#include <cmath>

namespace sim {

namespace {

constexpr int domain_chunk = 256;
constexpr double touching =
    1.7;  // farther apart the centres of domains that touch are not, in domain edges
constexpr double watched = 2.4;  // that distances of strangers are known up to, in domain edges

}  // namespace

bool FoldWatch::is_folded(const Field& x) {
    // Strangers are as far apart as when last looked at, less what any two corners have moved towards each other.
    const int n = surface_->lattice->n_corners();
    if (!checked_.empty()) {
        const Vec3 first = unpadded(x[surface_->begin]) - checked_[0];
        double squared = 0;
        for (int c = 0; c < n; ++c)
            squared = std::max(
                squared,
                (unpadded(x[surface_->begin + c]) - checked_[c] - first).squaredNorm());
        if (2 * std::sqrt(squared) < reach_)
            return false;
    }
    const double edge = surface_->lattice->edge;
    const double nearest = nearest_strangers(x, watched * edge);
    reach_ = nearest - touching * edge;
    checked_.clear();
    if (reach_ > 0)
        for (int c = 0; c < n; ++c)
            checked_.push_back(unpadded(x[surface_->begin + c]));
    return !(reach_ > 0);
}

double FoldWatch::nearest_strangers(const Field& x, double within) const {
    const std::vector<int>& shell = surface_->shell;
    std::vector<Vec3> centres;
    for (const int p : shell) {
        Vec3 centre = Vec3::Zero();
        for (const Vec3& corner : surface_->domain_corners(p, x))
            centre += corner / 8;
        centres.push_back(centre);
    }
    const PointGrid grid(centres, within);
    const int n = static_cast<int>(shell.size());
    std::vector<double> parts((n + domain_chunk - 1) / domain_chunk, within * within);
    for_chunks(n, domain_chunk, [&](int begin, int end) {
        double& least = parts[begin / domain_chunk];
        for (int i = begin; i < end; ++i) {
            const auto& cell = surface_->lattice->cell[shell[i]];
            grid.near(centres[i], [&](int j) {
                const double squared = (centres[i] - centres[j]).squaredNorm();
                if (j <= i || squared >= least)
                    return;
                const auto& other = surface_->lattice->cell[shell[j]];
                double at_rest = 0;
                for (int k = 0; k < 3; ++k)
                    at_rest += (cell[k] - other[k]) * (cell[k] - other[k]);
                if (at_rest > neighbourhood * neighbourhood)
                    least = squared;
            });
        }
    });
    double least = within * within;
    for (const double part : parts)
        least = std::min(least, part);
    return std::sqrt(least);
}

}  // namespace sim
