#include "render/scene/creases.h"

#include "assets/mesh/joined_corners.h"

#include <Eigen/Geometry>

#include <cmath>

namespace render {

namespace {

using Triangle = std::array<int, 3>;

// Twice the area along the unit normal.
Vec3f area_normal(const Triangle& triangle, const std::vector<Vec3f>& x) {
    const Vec3f& a = x[triangle[0]];
    return (x[triangle[1]] - a).cross(x[triangle[2]] - a);
}

}  // namespace

SplitTopology split_creases(const std::vector<Triangle>& triangles,
                            const std::vector<Vec3f>& rest_positions,
                            float crease_angle_deg) {
    const float min_cosine = std::cos(crease_angle_deg * float(M_PI) / 180);
    const std::vector<int> joined = assets::joined_corners(triangles, [&](int t, int u) {
        const Vec3f n = area_normal(triangles[t], rest_positions);
        const Vec3f m = area_normal(triangles[u], rest_positions);
        return n.dot(m) >= min_cosine * n.norm() * m.norm();
    });

    SplitTopology split;
    split.triangles.resize(triangles.size());
    std::vector<int> n_sets_at(rest_positions.size(), 0);
    for (int c = 0; c < int(3 * triangles.size()); ++c) {
        const int root = joined[c];
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
