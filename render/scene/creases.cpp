#include "render/scene/creases.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace render {

namespace {

using Triangle = std::array<int, 3>;

// Twice the area along the unit normal.
Vec3f area_normal(const Triangle& triangle, const std::vector<Vec3f>& x) {
    const Vec3f& a = x[triangle[0]];
    return (x[triangle[1]] - a).cross(x[triangle[2]] - a);
}

// Sets of corners (3 t + k) that share one split vertex: a disjoint-set forest.
class CornerSets {
  public:
    explicit CornerSets(int n_corners) : parent_(n_corners) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    int find(int corner) {
        while (parent_[corner] != corner)
            corner = parent_[corner] = parent_[parent_[corner]];
        return corner;
    }

    void join(int a, int b) {
        a = find(a), b = find(b);
        parent_[std::max(a, b)] =
            std::min(a, b);  // the root is the first corner, whatever the order
    }

  private:
    std::vector<int> parent_;
};

struct HalfEdge {
    int low, high;  // vertices in ascending order
    int triangle;
    int at_low, at_high;  // corners
};

std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles) {
    std::vector<HalfEdge> edges;
    edges.reserve(3 * triangles.size());
    for (int t = 0; t < int(triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const int l = (k + 1) % 3;
            const int a = triangles[t][k], b = triangles[t][l];
            edges.push_back(a < b ? HalfEdge{a, b, t, 3 * t + k, 3 * t + l}
                                  : HalfEdge{b, a, t, 3 * t + l, 3 * t + k});
        }
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& p, const HalfEdge& q) {
        return std::tie(p.low, p.high, p.triangle) < std::tie(q.low, q.high, q.triangle);
    });
    return edges;
}

}  // namespace

SplitTopology split_creases(const std::vector<Triangle>& triangles,
                            const std::vector<Vec3f>& rest_positions,
                            float crease_angle_deg) {
    const float min_cosine = std::cos(crease_angle_deg * float(M_PI) / 180);
    CornerSets sets(int(3 * triangles.size()));
    const std::vector<HalfEdge> edges = sorted_half_edges(triangles);
    for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
        const HalfEdge &p = edges[e], &q = edges[e + 1];
        if (p.low != q.low || p.high != q.high)
            continue;
        const Vec3f n_p = area_normal(triangles[p.triangle], rest_positions);
        const Vec3f n_q = area_normal(triangles[q.triangle], rest_positions);
        if (n_p.dot(n_q) < min_cosine * n_p.norm() * n_q.norm())
            continue;
        sets.join(p.at_low, q.at_low);
        sets.join(p.at_high, q.at_high);
    }

    SplitTopology split;
    split.triangles.resize(triangles.size());
    std::vector<int> n_sets_at(rest_positions.size(), 0);
    for (int c = 0; c < int(3 * triangles.size()); ++c) {
        const int root = sets.find(c);
        int& index = split.triangles[c / 3][c % 3];
        if (root != c) {
            index = split.triangles[root / 3][root % 3];
            continue;
        }
        index = int(split.source.size());
        split.source.push_back(triangles[c / 3][c % 3]);
        ++n_sets_at[split.source.back()];
    }
    for (const int vertex : split.source)
        split.on_crease.push_back(n_sets_at[vertex] > 1);
    return split;
}

std::vector<Vec3f> split_normals(const SplitTopology& topology,
                                 const std::vector<Vec3f>& positions,
                                 const std::vector<Vec3f>& normals) {
    std::vector<Vec3f> result(topology.source.size(), Vec3f::Zero());
    for (const Triangle& triangle : topology.triangles) {
        if (!topology.on_crease[triangle[0]] && !topology.on_crease[triangle[1]]
            && !topology.on_crease[triangle[2]])
            continue;
        const Triangle source{topology.source[triangle[0]],
                              topology.source[triangle[1]],
                              topology.source[triangle[2]]};
        const Vec3f normal = area_normal(source, positions);
        for (const int vertex : triangle)
            result[vertex] += normal;
    }
    for (std::size_t s = 0; s < result.size(); ++s) {
        const float length = result[s].norm();
        const bool own = topology.on_crease[s] && length > 0;
        result[s] = own ? Vec3f(result[s] / length) : normals[topology.source[s]];
    }
    return result;
}

}  // namespace render
