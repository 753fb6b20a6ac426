#include "sim/embedding/creases.h"

#include "assets/mesh/joined_corners.h"

#include <Eigen/Geometry>

#include <cmath>

namespace sim {

namespace {

std::vector<Vec3> face_normals(const assets::TriangleMesh& mesh) {
    std::vector<Vec3> normals;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3& x = mesh.positions[a];
        normals.push_back(
            (mesh.positions[b] - x).cross(mesh.positions[c] - x).stableNormalized());
    }
    return normals;
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
    const std::vector<int> joined = assets::joined_corners(mesh.triangles, [&](int t, int u) {
        const Vec3 &n = of_face[t], &m = of_face[u];
        const bool without_area = n.isZero() || m.isZero();
        return without_area || n.dot(m) >= std::cos(crease_angle);
    });
    CreasedMesh split;
    split.triangles.resize(mesh.triangles.size());
    std::vector<int> vertex_of_root(3 * mesh.triangles.size(), -1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int i = 0; i < 3; ++i) {
            int& vertex = vertex_of_root[joined[3 * t + i]];
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
