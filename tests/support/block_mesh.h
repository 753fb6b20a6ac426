// Closed meshes of blocks: forks, legs and other parts that meet or do not.
#pragma once

#include "assets/mesh/triangle_mesh.h"

#include <array>
#include <map>
#include <vector>

namespace tests {

/// The surface of those cells of a grid with planes at `planes` (x, y, z ascending) that `is_filled(i, j, k)` names,
/// with outward triangles.
template <class IsFilled>
assets::TriangleMesh block_mesh(const std::array<std::vector<double>, 3>& planes,
                                const IsFilled& is_filled) {
    assets::TriangleMesh mesh;
    std::map<std::array<int, 3>, int> vertex_at;
    const auto vertex = [&](const std::array<int, 3>& at) {
        const auto [found, is_new] =
            vertex_at.try_emplace(at, static_cast<int>(mesh.positions.size()));
        if (is_new)
            mesh.positions.emplace_back(planes[0][at[0]], planes[1][at[1]], planes[2][at[2]]);
        return found->second;
    };
    std::array<int, 3> n;
    for (int axis = 0; axis < 3; ++axis)
        n[axis] = static_cast<int>(planes[axis].size()) - 1;
    const auto filled = [&](const std::array<int, 3>& c) {
        for (int axis = 0; axis < 3; ++axis)
            if (c[axis] < 0 || c[axis] >= n[axis])
                return false;
        return static_cast<bool>(is_filled(c[0], c[1], c[2]));
    };
    for (int k = 0; k < n[2]; ++k)
        for (int j = 0; j < n[1]; ++j)
            for (int i = 0; i < n[0]; ++i)
                for (int face = 0; face < 6 && filled({i, j, k}); ++face) {
                    const int axis = face / 2, side = face % 2;
                    std::array<int, 3> beside{i, j, k};
                    beside[axis] += 2 * side - 1;
                    if (filled(beside))
                        continue;
                    // Counter-clockwise from outside.
                    std::array<int, 4> q;
                    for (int corner = 0; corner < 4; ++corner) {
                        std::array<int, 3> at{i, j, k};
                        at[axis] += side;
                        const int turn = side ? corner : 3 - corner;
                        at[(axis + 1) % 3] += turn == 1 || turn == 2;
                        at[(axis + 2) % 3] += turn >= 2;
                        q[corner] = vertex(at);
                    }
                    mesh.triangles.push_back({q[0], q[1], q[2]});
                    mesh.triangles.push_back({q[0], q[2], q[3]});
                }
    return mesh;
}

/// A fork of edge-s cubes along x: a joint of two cubes, then two prongs 0.3 s thick and 0.4 s apart, `length` cubes long.
inline assets::TriangleMesh fork(double s, int length) {
    return block_mesh({{{0, 2 * s, (2 + length) * s}, {0, s}, {0, 0.3 * s, 0.7 * s, s}}},
                      [](int i, int, int k) { return i == 0 || k != 1; });
}

}  // namespace tests
