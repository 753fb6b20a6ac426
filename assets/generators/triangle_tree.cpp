#include "assets/generators/triangle_tree.h"

#include "assets/base/error.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace assets {

namespace {

constexpr int triangles_per_leaf = 4;

double squared_distance_to_edge(const Vec3& x, const Vec3& a, const Vec3& b) {
    const Vec3 edge = b - a;
    const double length_squared = edge.squaredNorm();
    const double along = length_squared > 0 ? (x - a).dot(edge) / length_squared : 0;
    return (x - a - std::clamp(along, 0.0, 1.0) * edge).squaredNorm();
}

}  // namespace

double squared_distance(const Vec3& x, const std::array<Vec3, 3>& triangle) {
    const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    double nearest = std::numeric_limits<double>::infinity();
    bool above_face = normal.squaredNorm() > 0;
    for (int i = 0; i < 3; ++i) {
        const Vec3& a = triangle[i];
        const Vec3& b = triangle[(i + 1) % 3];
        above_face &= normal.cross(b - a).dot(x - a) >= 0;
        nearest = std::min(nearest, squared_distance_to_edge(x, a, b));
    }
    if (!above_face)
        return nearest;
    const double height = normal.dot(x - triangle[0]);
    return height * height / normal.squaredNorm();
}

TriangleTree::TriangleTree(const TriangleMesh& mesh, const std::vector<int>& triangles) {
    check(!triangles.empty(), "a triangle tree needs a triangle");
    for (const int t : triangles) {
        const auto& [a, b, c] = mesh.triangles[t];
        triangles_.push_back({mesh.positions[a], mesh.positions[b], mesh.positions[c]});
    }
    build(0, static_cast<int>(triangles_.size()));
}

void TriangleTree::build(int begin, int end) {
    const std::size_t node = nodes_.size();
    nodes_.emplace_back();
    Vec3 min = triangles_[begin][0], max = min;
    for (int t = begin; t < end; ++t)
        for (const Vec3& corner : triangles_[t]) {
            min = min.cwiseMin(corner);
            max = max.cwiseMax(corner);
        }
    nodes_[node] = {min, max, begin, end, 0};
    if (end - begin <= triangles_per_leaf)
        return;
    int axis = 0;
    (max - min).maxCoeff(&axis);
    const auto center = [axis](const Corners& corners) {
        return corners[0][axis] + corners[1][axis] + corners[2][axis];
    };
    const int middle = (begin + end) / 2;
    std::nth_element(triangles_.begin() + begin,
                     triangles_.begin() + middle,
                     triangles_.begin() + end,
                     [&](const Corners& a, const Corners& b) { return center(a) < center(b); });
    build(begin, middle);
    nodes_[node].second_child = static_cast<int>(nodes_.size());
    build(middle, end);
}

double TriangleTree::distance(const Vec3& x) const {
    const auto to_box = [&](int node) {
        return (nodes_[node].min - x)
            .cwiseMax(x - nodes_[node].max)
            .cwiseMax(0.0)
            .squaredNorm();
    };

    struct Waiting {
        int node;
        double squared;  // distance to its box
    };

    std::array<Waiting, 64> waiting;  // halving leaves no more than two per level
    int n_waiting = 0;
    waiting[n_waiting++] = {0, to_box(0)};
    double nearest = std::numeric_limits<double>::infinity();
    while (n_waiting > 0) {
        const auto [at, squared] = waiting[--n_waiting];
        if (squared >= nearest)
            continue;
        const Node& node = nodes_[at];
        if (node.second_child == 0) {
            for (int t = node.begin; t < node.end; ++t)
                nearest = std::min(nearest, squared_distance(x, triangles_[t]));
            continue;
        }
        Waiting near{at + 1, to_box(at + 1)}, far{node.second_child, to_box(node.second_child)};
        if (far.squared < near.squared)
            std::swap(near, far);
        waiting[n_waiting++] = far;
        waiting[n_waiting++] = near;
    }
    return std::sqrt(nearest);
}

}  // namespace assets
