#include "sim/embedding/creases.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace sim {

namespace {

/// Corners of triangles, numbered 3 t + i, joined where they are one vertex.
class JoinedCorners {
  public:
    explicit JoinedCorners(std::size_t n) : parent_(n) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    int root(int corner) {
        while (parent_[corner] != corner)
            corner = parent_[corner] = parent_[parent_[corner]];
        return corner;
    }

    /// The lowest corner stays the root, so that numbering does not depend on the order of joins.
    void join(int a, int b) {
        const auto [low, high] = std::minmax({root(a), root(b)});
        parent_[high] = low;
    }

  private:
    std::vector<int> parent_;
};

struct Edge {
    int low = 0, high = 0;                      // vertices
    int corner_at_low = 0, corner_at_high = 0;  // of one triangle
};

std::vector<Edge> sorted_edges(const assets::TriangleMesh& mesh) {
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, first = static_cast<int>(3 * t);
            Edge edge{mesh.triangles[t][i], mesh.triangles[t][j], first + i, first + j};
            if (edge.low > edge.high)
                edge = {edge.high, edge.low, edge.corner_at_high, edge.corner_at_low};
            edges.push_back(edge);
        }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.corner_at_low)
               < std::tie(b.low, b.high, b.corner_at_low);
    });
    return edges;
}

std::vector<Vec3> face_normals(const assets::TriangleMesh& mesh) {
    std::vector<Vec3> normals;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3& x = mesh.positions[a];
        normals.push_back(
            (mesh.positions[b] - x).cross(mesh.positions[c] - x).stableNormalized());
    }
    return normals;
}

JoinedCorners join_smooth_edges(const assets::TriangleMesh& mesh,
                                const std::vector<Vec3>& normals,
                                double crease_angle) {
    JoinedCorners joined(3 * mesh.triangles.size());
    const std::vector<Edge> edges = sorted_edges(mesh);
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        while (end < edges.size() && edges[end].low == edges[begin].low
               && edges[end].high == edges[begin].high)
            ++end;
        if (end - begin != 2)
            continue;
        const Edge &one = edges[begin], &other = edges[begin + 1];
        const Vec3 &n = normals[one.corner_at_low / 3], &m = normals[other.corner_at_low / 3];
        const bool without_area = n.isZero() || m.isZero();
        if (without_area || n.dot(m) >= std::cos(crease_angle)) {
            joined.join(one.corner_at_low, other.corner_at_low);
            joined.join(one.corner_at_high, other.corner_at_high);
        }
    }
    return joined;
}

double angle_at(const assets::TriangleMesh& mesh, std::size_t t, int i) {
    const auto& triangle = mesh.triangles[t];
    const Vec3& x = mesh.positions[triangle[i]];
    const Vec3 a = mesh.positions[triangle[(i + 1) % 3]] - x,
               b = mesh.positions[triangle[(i + 2) % 3]] - x;
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

CreasedMesh split_creases(const assets::TriangleMesh& mesh, double crease_angle) {
    const std::vector<Vec3> of_face = face_normals(mesh);
    JoinedCorners joined = join_smooth_edges(mesh, of_face, crease_angle);
    CreasedMesh split;
    split.triangles.resize(mesh.triangles.size());
    std::vector<int> vertex_of_root(3 * mesh.triangles.size(), -1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int i = 0; i < 3; ++i) {
            int& vertex = vertex_of_root[joined.root(static_cast<int>(3 * t) + i)];
            if (vertex < 0) {
                vertex = static_cast<int>(split.positions.size());
                split.positions.push_back(mesh.positions[mesh.triangles[t][i]]);
                split.normals.push_back(Vec3::Zero());
            }
            split.triangles[t][i] = vertex;
            split.normals[vertex] += angle_at(mesh, t, i) * of_face[t];
        }
    // A vertex of triangles without area, or of opposite ones, has no normal: any unit vector will do.
    for (Vec3& normal : split.normals)
        normal = normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3(Vec3::UnitZ());
    return split;
}

}  // namespace sim
