#include "assets/mesh/repair.h"

#include "assets/mesh/text.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace assets {
namespace {

// The uses of the edges that have one triangle, sorted by edge.
std::vector<EdgeUse> boundary(const TriangleMesh& mesh) {
    std::vector<EdgeUse> single;
    const std::vector<EdgeUse> uses = sorted_edge_uses(mesh.triangles);
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() == 1)
            single.push_back(edge[0]);
    });
    return single;
}

Hole measured(const TriangleMesh& mesh, const std::vector<EdgeUse>& loop) {
    Hole hole{loop, loop_center(mesh, loop), 0, 0};
    Eigen::AlignedBox3d bounds;
    Vec3 normal = Vec3::Zero();
    for (const EdgeUse& edge : loop) {
        const Vec3& p = mesh.positions[edge.from()];
        bounds.extend(p);
        normal += (p - hole.center).cross(mesh.positions[edge.to()] - hole.center);
    }
    hole.size = bounds.diagonal().norm();
    normal.stableNormalize();
    for (const EdgeUse& edge : loop) {
        const double distance = normal.dot(mesh.positions[edge.from()] - hole.center);
        hole.unevenness = std::max(hole.unevenness, std::abs(distance));
    }
    return hole;
}

void add_fan(TriangleMesh& mesh, const Hole& hole) {
    const int center = static_cast<int>(mesh.positions.size());
    mesh.positions.push_back(hole.center);
    for (const EdgeUse& edge : hole.edges) {
        mesh.triangles.push_back({edge.to(), edge.from(), center});
        if (!mesh.groups.empty())
            mesh.triangle_group.push_back(mesh.triangle_group[edge.triangle]);
    }
}

}  // namespace

Vec3 loop_center(const TriangleMesh& mesh, const std::vector<EdgeUse>& loop) {
    const Vec3& origin = mesh.positions[loop.front().from()];
    Vec3 moment = Vec3::Zero();
    double length = 0;
    for (const EdgeUse& edge : loop) {
        const Vec3 p = mesh.positions[edge.from()] - origin;
        const Vec3 q = mesh.positions[edge.to()] - origin;
        moment += (q - p).norm() * (p + q) / 2;
        length += (q - p).norm();
    }
    return length > 0 ? Vec3(origin + moment / length) : origin;
}

int boundary_edge_count(const TriangleMesh& mesh) {
    return static_cast<int>(boundary(mesh).size());
}

std::vector<Hole> find_holes(const TriangleMesh& mesh) {
    std::vector<Hole> holes;
    for (const std::vector<EdgeUse>& loop : simple_loops(boundary(mesh)))
        holes.push_back(measured(mesh, loop));
    return holes;
}

TriangleMesh close_holes(const TriangleMesh& mesh, std::vector<std::string>* repairs) {
    TriangleMesh closed = mesh;
    for (const Hole& hole : find_holes(mesh)) {
        add_fan(closed, hole);
        repairs->push_back(fmt::format(
            "A hole of {} edges, {:.3g} m across, was closed.", hole.edges.size(), hole.size));
    }
    const int open = boundary_edge_count(closed);
    if (open > 0)
        repairs->push_back(
            fmt::format("{} open: they form no simple loop.",
                        counted(static_cast<size_t>(open), "edge stays", "edges stay")));
    return closed;
}

}  // namespace assets
