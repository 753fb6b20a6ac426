#include "assets/mesh/triangle_mesh.h"

#include <Eigen/Geometry>

namespace assets {

double signed_volume(const TriangleMesh& mesh) {
    if (mesh.triangles.empty())
        return 0;
    // A closed mesh has the same volume about any point: one of its own keeps the rounding small.
    const Vec3 origin = mesh.positions[mesh.triangles.front()[0]];
    double volume = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 p = mesh.positions[a] - origin;
        const Vec3 q = mesh.positions[b] - origin;
        const Vec3 r = mesh.positions[c] - origin;
        volume += p.dot(q.cross(r)) / 6;
    }
    return volume;
}

std::vector<Vec3> vertex_normals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3& p = mesh.positions[a];
        const Vec3 twice_area = (mesh.positions[b] - p).cross(mesh.positions[c] - p);
        for (const int v : {a, b, c})
            normals[v] += twice_area;
    }
    for (Vec3& normal : normals)
        normal.stableNormalize();  // leaves zero as it is
    return normals;
}

}  // namespace assets
