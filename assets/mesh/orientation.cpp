#include "assets/mesh/orientation.h"

#include "assets/mesh/edges.h"
#include "assets/mesh/repair.h"
#include "assets/mesh/text.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>
#include <utility>

namespace assets {
namespace {

// Holes above this part of the area leave no clear inside. A box without its lid has a fifth.
constexpr double largest_hole_fraction = 0.25;

// Disjoint sets of triangles that also know whether a triangle faces as the root of its set does.
class FacingSets {
  public:
    explicit FacingSets(size_t n) : parent_(n), opposite_(n, false) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    struct Place {
        int root;
        bool opposite;  // to the root
    };

    Place find(int t) {
        Place place{t, false};
        for (; parent_[place.root] != place.root; place.root = parent_[place.root])
            place.opposite ^= opposite_[place.root];
        // Hang all on the way directly below the root.
        for (Place at{t, place.opposite};
             parent_[at.root] != place.root && at.root != place.root;) {
            const Place above{parent_[at.root], at.opposite != opposite_[at.root]};
            parent_[at.root] = place.root;
            opposite_[at.root] = at.opposite;
            at = above;
        }
        return place;
    }

    /// Notes that s and t face alike or oppositely; false where that contradicts what was noted
    /// before.
    bool join(int s, int t, bool opposite) {
        const Place a = find(s);
        const Place b = find(t);
        const bool roots_opposite = (a.opposite != b.opposite) != opposite;
        if (a.root == b.root)
            return !roots_opposite;
        // The lowest triangle is the root, whatever the order of the calls.
        const auto [root, child] = std::minmax(a.root, b.root);
        parent_[child] = root;
        opposite_[child] = roots_opposite;
        return true;
    }

  private:
    std::vector<int> parent_;
    std::vector<char> opposite_;  // to the parent
};

struct Part {
    double area = 0;           // [m²]
    double opposite_area = 0;  // of the triangles that face against the root [m²]
    double volume = 0;         // with the holes closed, if all face as the root does [m³]
    double hole_area = 0;      // [m²]
    Vec3 origin{0, 0, 0};      // a vertex, to measure volumes from
    Eigen::AlignedBox3d bounds;
    bool one_sided = false;
    size_t n_triangles = 0;
    size_t n_turned = 0;
    std::vector<EdgeUse> border;  // directed as the root faces

    /// Whether the triangles that face as the root does are wrong.
    bool root_is_wrong() const {
        if (hole_area > largest_hole_fraction * area)
            return opposite_area > area - opposite_area;
        return volume < 0;
    }
};

// The surface in parts, as first found.
struct Parts {
    std::vector<int> part;       // (#T)
    std::vector<char> opposite;  // (#T) faces against the root of its part
    std::vector<Part> parts;
};

void add_triangles(const TriangleMesh& mesh, Parts& found) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        Part& part = found.parts[found.part[t]];
        const Vec3 p = mesh.positions[a] - part.origin;
        const Vec3 q = mesh.positions[b] - part.origin;
        const Vec3 r = mesh.positions[c] - part.origin;
        for (const int v : {a, b, c})
            part.bounds.extend(mesh.positions[v]);
        ++part.n_triangles;
        const double area = (q - p).cross(r - p).norm() / 2;
        part.area += area;
        part.opposite_area += found.opposite[t] ? area : 0;
        part.volume += (found.opposite[t] ? -1 : 1) * p.dot(q.cross(r)) / 6;
    }
}

void close_by_fans(const TriangleMesh& mesh, Part& part) {
    for (const std::vector<EdgeUse>& loop : simple_loops(part.border)) {
        const Vec3 center = loop_center(mesh, loop) - part.origin;
        for (const EdgeUse& edge : loop) {
            const Vec3 p = mesh.positions[edge.from()] - part.origin;
            const Vec3 q = mesh.positions[edge.to()] - part.origin;
            part.hole_area += (p - center).cross(q - center).norm() / 2;
            part.volume += center.dot(q.cross(p)) / 6;
        }
    }
}

Parts find_parts(const TriangleMesh& mesh) {
    const size_t n = mesh.triangles.size();
    FacingSets sets(n);
    std::vector<EdgeUse> border;
    std::vector<int> contradicted;
    const std::vector<EdgeUse> uses = sorted_edge_uses(mesh.triangles);
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() != 2)
            border.insert(border.end(), edge.begin(), edge.end());
        else if (!sets.join(
                     edge[0].triangle, edge[1].triangle, edge[0].forward == edge[1].forward))
            contradicted.push_back(edge[0].triangle);
    });

    Parts found{std::vector<int>(n), std::vector<char>(n), {}};
    for (int t = 0; t < static_cast<int>(n); ++t) {
        const auto [root, opposite] = sets.find(t);
        if (root == t) {  // comes before all others of its part
            found.part[t] = static_cast<int>(found.parts.size());
            found.parts.emplace_back().origin = mesh.positions[mesh.triangles[t][0]];
        }
        found.part[t] = found.part[root];
        found.opposite[t] = opposite;
    }
    for (EdgeUse use : border) {
        use.forward ^= static_cast<bool>(found.opposite[use.triangle]);
        found.parts[found.part[use.triangle]].border.push_back(use);
    }
    for (const int t : contradicted)
        found.parts[found.part[t]].one_sided = true;
    return found;
}

void turn_wrong_triangles(TriangleMesh& mesh, Parts& found) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        Part& part = found.parts[found.part[t]];
        if (static_cast<bool>(found.opposite[t]) == part.root_is_wrong())
            continue;
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        ++part.n_turned;
    }
}

bool is_inside_another(const Part& part, const std::vector<Part>& parts) {
    return std::any_of(parts.begin(), parts.end(), [&](const Part& other) {
        return &other != &part && other.bounds.contains(part.bounds);
    });
}

// Tells parts turned as a whole from single triangles: the first are inside out, the others
// inconsistent.
void tell_turned(const std::vector<Part>& parts, std::vector<std::string>* repairs) {
    size_t n_whole = 0;
    size_t n_nested = 0;
    size_t n_single = 0;
    size_t n_one_sided = 0;
    for (const Part& part : parts) {
        const bool whole = part.n_turned == part.n_triangles;
        n_whole += whole;
        n_nested += whole && is_inside_another(part, parts);
        n_single += whole ? 0 : part.n_turned;
        n_one_sided += part.one_sided;
    }
    if (n_whole > 0)
        repairs->push_back(fmt::format("{} inside out (of {}) and turned to face outward.",
                                       counted(n_whole, "part was", "parts were"),
                                       parts.size()));
    if (n_nested > 0)
        repairs->push_back(fmt::format(
            "{} turned inside the bounds of another: a solid of its own now, no cavity.",
            counted(n_nested, "part was", "parts were")));
    if (n_single > 0)
        repairs->push_back(fmt::format("{} turned to face as their neighbours do.",
                                       counted(n_single, "triangle was", "triangles were")));
    if (n_one_sided > 0)
        repairs->push_back(
            fmt::format("{} one-sided, like a Möbius strip, and cannot be oriented.",
                        counted(n_one_sided, "part is", "parts are")));
}

}  // namespace

void orient_outward(TriangleMesh& mesh, std::vector<std::string>* repairs) {
    Parts found = find_parts(mesh);
    add_triangles(mesh, found);
    for (Part& part : found.parts)
        close_by_fans(mesh, part);
    turn_wrong_triangles(mesh, found);
    tell_turned(found.parts, repairs);
}

}  // namespace assets
