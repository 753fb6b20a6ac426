#include "sim/contact/vertex_block.h"

#include <algorithm>
#include <array>

namespace sim {

namespace {

VertexBlock::Four side_by_side(const std::array<Vec3p, 4>& points) {
    const auto& [a, b, c, d] = points;
    return {Vec3p{a[0], b[0], c[0], d[0]},
            Vec3p{a[1], b[1], c[1], d[1]},
            Vec3p{a[2], b[2], c[2], d[2]}};
}

/// point(k) of n points, the last one repeated.
template <class Point>
void fill(std::vector<VertexBlock::Four>& fours, int n, const Point& point) {
    for (int four = 0; 4 * four < n; ++four) {
        std::array<Vec3p, 4> points;
        for (int lane = 0; lane < 4; ++lane)
            points[lane] = point(std::min(4 * four + lane, n - 1));
        fours[four] = side_by_side(points);
    }
}

}  // namespace

VertexBlock::VertexBlock(const ContactSurface& surface, std::vector<int> of_surface)
    : vertices(std::move(of_surface)), rest((vertices.size() + 3) / 4), now(rest.size()) {
    fill(rest, static_cast<int>(vertices.size()), [&](int k) {
        return padded(surface.vertices[vertices[k]].rest);
    });
    for (const int v : vertices)
        for (const int c : surface.vertices[v].corners)
            carriers.push_back(c - surface.begin);
    std::sort(carriers.begin(), carriers.end());
    carriers.erase(std::unique(carriers.begin(), carriers.end()), carriers.end());
}

void VertexBlock::place(const ContactSurface& surface, const Field& corners) {
    PaddedBounds all;
    fill(now, static_cast<int>(vertices.size()), [&](int k) {
        const ContactVertex& vertex = surface.vertices[vertices[k]];
        Vec3p sum{};
        for (int a = 0; a < 8; ++a)
            sum += vertex.weights[a] * corners[vertex.corners[a] - surface.begin];
        all.add(sum);
        return sum;
    });
    bounds = all;
}

}  // namespace sim
