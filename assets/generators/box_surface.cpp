#include "assets/base/error.h"
#include "assets/generators/procedural_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace assets {

namespace {

class BoxTessellation {
  public:
    BoxTessellation(const Box& box, double spacing) : box_(box) {
        for (int axis = 0; axis < 3; ++axis) {
            // A hair's tolerance, so that a length of exactly n spacings is not cut into n + 1.
            const double n = std::ceil((box.max[axis] - box.min[axis]) / spacing - 1e-6);
            check(n < 1e6, "a box is tessellated into fewer than a million parts an edge");
            n_[axis] = std::max(1, static_cast<int>(n));
        }
    }

    TriangleMesh mesh() && {
        for (int axis = 0; axis < 3; ++axis)
            for (const bool upper : {false, true})
                add_face(axis, upper);
        return std::move(mesh_);
    }

  private:
    void add_face(int axis, bool upper) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        std::array<int, 3> node{};
        node[axis] = upper ? n_[axis] : 0;
        const auto vertex_at = [&](int i, int j) {
            node[u] = i;
            node[v] = j;
            return vertex(node);
        };
        for (int j = 0; j < n_[v]; ++j)
            for (int i = 0; i < n_[u]; ++i) {
                int a = vertex_at(i, j), b = vertex_at(i + 1, j);
                int c = vertex_at(i + 1, j + 1), d = vertex_at(i, j + 1);
                if (!upper)
                    std::swap(b, d);
                mesh_.triangles.push_back({a, b, c});
                mesh_.triangles.push_back({a, c, d});
            }
    }

    int vertex(const std::array<int, 3>& node) {
        const std::int64_t key =
            (static_cast<std::int64_t>(node[2]) * (n_[1] + 1) + node[1]) * (n_[0] + 1)
            + node[0];
        const auto [found, is_new] =
            vertices_.emplace(key, static_cast<int>(mesh_.positions.size()));
        if (is_new) {
            Vec3 x;
            for (int axis = 0; axis < 3; ++axis)  // exact at both ends
                x[axis] = std::lerp(
                    box_.min[axis], box_.max[axis], static_cast<double>(node[axis]) / n_[axis]);
            mesh_.positions.push_back(x);
        }
        return found->second;
    }

    const Box& box_;
    std::array<int, 3> n_{};
    std::unordered_map<std::int64_t, int> vertices_;  // by node
    TriangleMesh mesh_;
};

}  // namespace

TriangleMesh box_surface(const Box& box, double spacing) {
    return BoxTessellation(box, spacing).mesh();
}

}  // namespace assets
