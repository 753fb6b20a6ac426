#include "sim/point_bodies.h"

#include <algorithm>

namespace sim {

std::vector<int> points_at(const Lattice& lattice, const std::vector<int>& corners) {
    std::vector<char> is_chosen(lattice.n_corners(), 0);
    for (const int c : corners)
        is_chosen[c] = 1;
    std::vector<int> result;
    for (int p = 0; p < lattice.n_domains(); ++p)
        if (std::any_of(lattice.corners[p].begin(), lattice.corners[p].end(), [&](int c) {
                return is_chosen[c];
            }))
            result.push_back(p);
    return result;
}

std::vector<double> point_shares(const Lattice& lattice, const std::vector<int>& corners) {
    double total = 0;
    std::vector<char> is_chosen(lattice.n_corners(), 0);
    for (const int c : corners) {
        is_chosen[c] = 1;
        total += lattice.corner_volume[c];
    }
    std::vector<double> share(lattice.n_domains(), 0);
    for (int p = 0; p < lattice.n_domains(); ++p)
        for (const int c : lattice.corners[p])
            if (is_chosen[c])
                share[p] += lattice.domain_volume(p) / 8 / total;
    return share;
}

std::vector<NearPoint> near_points(const MaterialPoints& points, const Vec3& X) {
    std::vector<NearPoint> near;
    NearPoint nearest{0, 1, X - points.rest[0]};
    double total = 0;
    for (int p = 0; p < points.size(); ++p) {
        const Vec3 offset = X - points.rest[p];
        if (offset.squaredNorm() < nearest.offset.squaredNorm())
            nearest = {p, 1, offset};
        const double weight =
            (Vec3::Ones() - offset.cwiseAbs() / points.spacing).cwiseMax(0).prod();
        if (weight > 0)
            near.push_back({p, weight, offset});
        total += weight;
    }
    if (near.empty())
        return {nearest};
    for (NearPoint& point : near)
        point.weight /= total;
    return near;
}

Vec3 carried(const std::vector<NearPoint>& near, const PointState& state, const Vec3p* x) {
    Vec3 sum = Vec3::Zero();
    for (const NearPoint& point : near)
        sum += point.weight
               * (unpadded(x[point.point])
                  + Eigen::Map<const Mat3>(state.F[point.point].m) * point.offset);
    return sum;
}

}  // namespace sim
