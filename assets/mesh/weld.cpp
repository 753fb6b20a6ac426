#include "assets/mesh/weld.h"

#include "assets/mesh/text.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

namespace assets {
namespace {

constexpr int none = -1;

Eigen::AlignedBox3d used_bounds(const TriangleMesh& mesh) {
    Eigen::AlignedBox3d bounds;
    for (const auto& triangle : mesh.triangles) {
        for (const int v : triangle)
            bounds.extend(mesh.positions[v]);
    }
    return bounds;
}

// Points hashed by the cell they lie in. Different cells may share a slot: the distance decides.
class PointHash {
  public:
    PointHash(const Vec3& origin, double reach, size_t capacity)
        : origin_(origin), reach_(reach), slots_(std::bit_ceil(2 * capacity + 1), none) {
        points_.reserve(capacity);
        next_.reserve(capacity);
    }

    /// The first point added within reach of x, or none.
    int find(const Vec3& x) const {
        const std::array<int64_t, 3> low = cell(x - Vec3::Constant(reach_));
        const std::array<int64_t, 3> high = cell(x + Vec3::Constant(reach_));
        int found = none;
        for (int64_t i = low[0]; i <= high[0]; ++i) {
            for (int64_t j = low[1]; j <= high[1]; ++j) {
                for (int64_t k = low[2]; k <= high[2]; ++k)
                    found = first_of(found, slots_[slot({i, j, k})], x);
            }
        }
        return found;
    }

    int add(const Vec3& x) {
        const int index = static_cast<int>(points_.size());
        int& head = slots_[slot(cell(x))];
        points_.push_back(x);
        next_.push_back(head);
        head = index;
        return index;
    }

    const Vec3& operator[](int index) const { return points_[index]; }

    std::vector<Vec3> take_points() { return std::move(points_); }

  private:
    // Cells are wider than the reach, so that most searches see one cell only.
    std::array<int64_t, 3> cell(const Vec3& x) const {
        const Vec3 scaled = ((x - origin_) / (8 * reach_)).array().floor();
        return {static_cast<int64_t>(scaled.x()),
                static_cast<int64_t>(scaled.y()),
                static_cast<int64_t>(scaled.z())};
    }

    size_t slot(const std::array<int64_t, 3>& cell) const {
        uint64_t hash = 0;
        for (const int64_t coordinate : cell) {
            hash = (hash ^ static_cast<uint64_t>(coordinate)) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 32;
        }
        return hash & (slots_.size() - 1);
    }

    int first_of(int found, int candidate, const Vec3& x) const {
        for (; candidate != none; candidate = next_[candidate]) {
            const bool earlier = found == none || candidate < found;
            if (earlier && (points_[candidate] - x).squaredNorm() <= reach_ * reach_)
                found = candidate;
        }
        return found;
    }

    Vec3 origin_;
    double reach_;
    std::vector<int> slots_;  // head of the chain of each slot
    std::vector<int> next_;
    std::vector<Vec3> points_;
};

size_t n_distinct(std::vector<Vec3> points) {
    std::sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    });
    return static_cast<size_t>(std::unique(points.begin(), points.end()) - points.begin());
}

// Keeps the triangles t with keep[t], in order.
void keep_triangles(TriangleMesh& mesh, const std::vector<bool>& keep) {
    size_t kept = 0;
    for (size_t t = 0; t < keep.size(); ++t) {
        if (!keep[t])
            continue;
        mesh.triangles[kept] = mesh.triangles[t];
        if (!mesh.groups.empty())
            mesh.triangle_group[kept] = mesh.triangle_group[t];
        ++kept;
    }
    mesh.triangles.resize(kept);
    if (!mesh.groups.empty())
        mesh.triangle_group.resize(kept);
}

std::array<int, 3> sorted(std::array<int, 3> triangle) {
    std::sort(triangle.begin(), triangle.end());
    return triangle;
}

using EdgeCounts = std::map<std::pair<int, int>, int>;

std::array<std::pair<int, int>, 3> edges_of(const std::array<int, 3>& triangle) {
    const auto [a, b, c] = sorted(triangle);
    return {{{a, b}, {a, c}, {b, c}}};
}

// How often the edges of the triangles chosen occur in the whole mesh.
EdgeCounts edge_counts(const TriangleMesh& mesh, const std::vector<int>& chosen) {
    EdgeCounts counts;
    for (const int t : chosen) {
        for (const auto& edge : edges_of(mesh.triangles[t]))
            counts[edge] = 0;
    }
    for (const auto& triangle : mesh.triangles) {
        for (const auto& edge : edges_of(triangle)) {
            if (const auto counted_edge = counts.find(edge); counted_edge != counts.end())
                ++counted_edge->second;
        }
    }
    return counts;
}

// Of the flat triangles, drops those without which no more edges are left open or overfull.
size_t drop_needless(const TriangleMesh& mesh,
                     const std::vector<int>& flat,
                     std::vector<bool>& keep) {
    EdgeCounts counts = edge_counts(mesh, flat);
    size_t dropped = 0;
    for (const int t : flat) {
        int faults_with = 0;
        int faults_without = 0;
        for (const auto& edge : edges_of(mesh.triangles[t])) {
            const int count = counts[edge];
            faults_with += count != 2;
            faults_without += count != 1 && count != 3;
        }
        if (faults_without > faults_with)
            continue;
        for (const auto& edge : edges_of(mesh.triangles[t]))
            --counts[edge];
        keep[t] = false;
        ++dropped;
    }
    return dropped;
}

double height(const TriangleMesh& mesh, const std::array<int, 3>& triangle) {
    const Vec3& a = mesh.positions[triangle[0]];
    const Vec3& b = mesh.positions[triangle[1]];
    const Vec3& c = mesh.positions[triangle[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return (b - a).cross(c - a).norm() / longest;
}

}  // namespace

double used_diagonal(const TriangleMesh& mesh) {
    return mesh.triangles.empty() ? 0 : used_bounds(mesh).diagonal().norm();
}

void weld(TriangleMesh& mesh, double tolerance, std::vector<std::string>* repairs) {
    std::vector<int> welded(mesh.positions.size(), none);
    for (const auto& triangle : mesh.triangles) {
        for (const int v : triangle)
            welded[v] = 0;  // used
    }
    PointHash hash(used_bounds(mesh).min(), tolerance, mesh.positions.size());
    std::vector<Vec3> moved;
    for (size_t v = 0; v < welded.size(); ++v) {
        if (welded[v] == none)
            continue;
        const Vec3& x = mesh.positions[v];
        welded[v] = hash.find(x);
        if (welded[v] == none)
            welded[v] = hash.add(x);
        else if (hash[welded[v]] != x)
            moved.push_back(x);
    }
    for (auto& triangle : mesh.triangles) {
        for (int& v : triangle)
            v = welded[v];
    }
    mesh.positions = hash.take_points();
    if (!moved.empty())
        repairs->push_back(
            fmt::format("{} merged with another within {:.2g} m.",
                        counted(n_distinct(moved), "vertex was", "vertices were"),
                        tolerance));
}

void drop_degenerate(TriangleMesh& mesh, double tolerance, std::vector<std::string>* repairs) {
    const size_t n = mesh.triangles.size();
    std::vector<bool> keep(n);
    for (size_t t = 0; t < n; ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        keep[t] = a != b && b != c && c != a;
    }
    keep_triangles(mesh, keep);
    size_t dropped = n - mesh.triangles.size();

    std::vector<int> flat;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (height(mesh, mesh.triangles[t]) <= tolerance)
            flat.push_back(static_cast<int>(t));
    }
    keep.assign(mesh.triangles.size(), true);
    dropped += drop_needless(mesh, flat, keep);
    keep_triangles(mesh, keep);
    if (dropped > 0)
        repairs->push_back(fmt::format("{} without area dropped.",
                                       counted(dropped, "triangle was", "triangles were")));
}

void drop_doubled(TriangleMesh& mesh, std::vector<std::string>* repairs) {
    const size_t n = mesh.triangles.size();
    std::vector<int> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::vector<std::array<int, 3>> keys(n);
    std::transform(mesh.triangles.begin(), mesh.triangles.end(), keys.begin(), sorted);
    std::stable_sort(
        order.begin(), order.end(), [&](int s, int t) { return keys[s] < keys[t]; });

    std::vector<bool> keep(n, true);
    size_t dropped = 0;
    for (size_t i = 1; i < n; ++i) {
        if (keys[order[i]] != keys[order[i - 1]])
            continue;
        keep[order[i]] = false;
        ++dropped;
    }
    keep_triangles(mesh, keep);
    if (dropped > 0)
        repairs->push_back(fmt::format("{} on the same three vertices as another dropped.",
                                       counted(dropped, "triangle was", "triangles were")));
}

}  // namespace assets
