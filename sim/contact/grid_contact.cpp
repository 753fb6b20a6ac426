#include "sim/contact/grid_contact.h"

#include "sim/base/floor.h"
#include "sim/contact/node_box.h"
#include "sim/contact/padded_bounds.h"
#include "sim/grid/kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace sim {

namespace {

constexpr int contact_sweeps = 3;
constexpr double seen_cells =
    2.5;                      // a node is up to one off a body, and sees the other for 1.5
constexpr int n_normals = 3;  // of both bodies together, and of each
constexpr double much_less = 2;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A corner's share of a node that both bodies share.
struct Share {
    int corner = 0, node = 0;
    double weight = 0;
};

/// One body's share of a node.
struct Side {
    double mass = 0;
    double volume = 0;  // [m³]
    Vec3p gradient{};   // of the volume [m²]
    Vec3p momentum{};
    Vec3p reach{};  // largest distance along each normal, outward
};

struct Node {
    std::array<Side, 2> side;
    std::array<Vec3p, 3>
        normals;  // out of the first body: entry n of [k] is component k of the n-th
    std::array<Vec3p, 2> dv{};

    Vec3 normal(int n) const { return {normals[0][n], normals[1][n], normals[2][n]}; }
};

PaddedBounds bounds_of(const ContactBody& body, const Field& x) {
    PaddedBounds bounds;
    for (int c = body.begin; c < body.end; ++c)
        bounds.add(x[c]);
    return bounds;
}

/// The part of space that holds both bodies, and all corners that a node which they share may see.
PaddedBounds common(const PaddedBounds& a, const PaddedBounds& b, double cell_size) {
    const double margin = seen_cells * cell_size;
    return {larger(a.low, b.low) - margin, smaller(a.high, b.high) + margin};
}

/// The lowest node of a stencil, and the distance from it in cells.
std::pair<std::array<long, 3>, Vec3p> place(const Vec3p& x, double h, double shift) {
    const Vec3p scaled = x / h, low = floor_of(scaled - shift);
    return {{static_cast<long>(low[0]), static_cast<long>(low[1]), static_cast<long>(low[2])},
            scaled - low};
}

}  // namespace

/// The nodes that two bodies share.
class GridContact::Pair {
  public:
    Pair(const GridPair& pair, const ContactFields& fields, const PaddedBounds& where)
        : fields_(fields), friction_(pair.friction) {
        std::array<std::vector<int>, 2> corners;
        for (int s = 0; s < 2; ++s) {
            const ContactBody& body = s == 0 ? pair.first : pair.second;
            for (int c = body.begin; c < body.end; ++c)
                if (where.holds(fields.x[c]))
                    corners[s].push_back(c);
        }
        const double h = pair.cell_size;
        NodeBox numbers(where.low, where.high, h);
        number_shared(corners, h, numbers);
        if (nodes_.empty())
            return;
        for (int s = 0; s < 2; ++s)
            for (const int c : corners[s]) {
                add_shares(s, c, h, numbers);
                add_gradient(s, c, h, numbers);
            }
        for (Node& node : nodes_)
            find_normals(node);
    }

    bool is_empty() const { return nodes_.empty(); }

    /// Appends the corners that see a shared node.
    void list_corners(std::vector<int>& corners) const {
        for (const std::vector<Share>& shares : shares_)
            for (const Share& share : shares)
                if (corners.empty() || corners.back() != share.corner)
                    corners.push_back(share.corner);
    }

    /// Returns whether the bodies have met anywhere; if not, nothing has changed.
    bool sweep(const Field& x_n, double dt, Field& velocity) {
        start_sweep();
        for (int s = 0; s < 2; ++s) {
            const double outward = s == 0 ? 1 : -1;
            for (const auto& [c, n, weight] : shares_[s]) {
                Node& node = nodes_[n];
                Side& side = node.side[s];
                side.momentum += weight * fields_.mass[c][0] * velocity[c];
                const Vec3p x = x_n[c] + dt * velocity[c];
                const Vec3p along =
                    node.normals[0] * x[0] + node.normals[1] * x[1] + node.normals[2] * x[2];
                side.reach = larger(side.reach, outward * along - fields_.outside[c]);
            }
        }
        bool have_met = false;
        for (Node& node : nodes_)
            have_met |= exchange(node, friction_);
        if (have_met)
            for (int s = 0; s < 2; ++s)
                for (const auto& [c, n, weight] : shares_[s])
                    velocity[c] += weight * nodes_[n].dv[s] * fields_.is_free[c];
        return have_met;
    }

  private:
    /// visit(node's number, weight) of the eight nodes of a corner's cell that it has a part in.
    template <class Visit>
    static void for_linear(const Vec3p& x, double h, NodeBox& numbers, const Visit& visit) {
        const auto [base, t] = place(x, h, 0);
        for (int a = 0; a < 8; ++a) {
            const int i = a & 1, j = a >> 1 & 1, k = a >> 2;
            const double weight =
                (i ? t[0] : 1 - t[0]) * (j ? t[1] : 1 - t[1]) * (k ? t[2] : 1 - t[2]);
            if (weight > 0)
                visit(numbers(base[0] + i, base[1] + j, base[2] + k), weight);
        }
    }

    void number_shared(const std::array<std::vector<int>, 2>& corners,
                       double h,
                       NodeBox& numbers) {
        constexpr int of_first = -2;
        for (const int c : corners[0])
            if (fields_.mass[c][0] > 0)
                for_linear(fields_.x[c], h, numbers, [&](int& n, double) { n = of_first; });
        for (const int c : corners[1])
            if (fields_.mass[c][0] > 0)
                for_linear(fields_.x[c], h, numbers, [&](int& n, double) {
                    if (n != of_first)
                        return;
                    n = static_cast<int>(nodes_.size());
                    nodes_.emplace_back();
                });
    }

    void add_shares(int s, int c, double h, NodeBox& numbers) {
        for_linear(fields_.x[c], h, numbers, [&](int n, double weight) {
            if (n < 0)
                return;
            shares_[s].push_back({c, n, weight});
            nodes_[n].side[s].mass += weight * fields_.mass[c][0];
        });
    }

    /// By quadratic splines: the slope of a linear one jumps where a corner passes a node, and a lattice that lies on the
    /// grid does so at every breath.
    void add_gradient(int s, int c, double h, NodeBox& numbers) {
        using Quadratic = Spline<2>;
        const auto [base, t] = place(fields_.x[c], h, Quadratic::shift);
        Vec3p w[Quadratic::n], slope[Quadratic::n];
        Quadratic::weights(t, w);
        Quadratic::slopes(t, slope);
        const double volume = fields_.volume[c], scale = volume / h;
        for (int k = 0; k < Quadratic::n; ++k)
            for (int j = 0; j < Quadratic::n; ++j)
                for (int i = 0; i < Quadratic::n; ++i) {
                    const int n = numbers(base[0] + i, base[1] + j, base[2] + k);
                    if (n < 0)
                        continue;
                    Side& side = nodes_[n].side[s];
                    side.volume += volume * w[i][0] * w[j][1] * w[k][2];
                    side.gradient += scale
                                     * Vec3p{slope[i][0] * w[j][1] * w[k][2],
                                             w[i][0] * slope[j][1] * w[k][2],
                                             w[i][0] * w[j][1] * slope[k][2],
                                             0};
                }
    }

    /// A weight grows as its corner nears the node: on the whole out of the body. At its rim the gradient of a body leans to
    /// its side. Where rims of both meet their mean does not; where only one ends, the other knows the face that they share.
    static void find_normals(Node& node) {
        const auto& [a, b] = node.side;
        const Vec3 out_of_first = unpadded(a.gradient) / a.volume,
                   into_second = -unpadded(b.gradient) / b.volume;
        const std::array<Vec3, n_normals> normals{
            out_of_first + into_second, out_of_first, into_second};
        for (int n = 0; n < n_normals; ++n) {
            const Vec3 normal = normals[n].norm() > 0 ? normals[n].normalized() : Vec3::Zero();
            for (int k = 0; k < 3; ++k)
                node.normals[k][n] = normal[k];
        }
    }

    /// The mean normal, or that of one body along which they overlap by much less than by the turn from one to the other
    /// alone. Zero where they do not overlap along one of them, for then a plane parts them.
    static Vec3 least_overlap(const Node& node) {
        Vec3 best = Vec3::Zero();
        double least = infinity;
        for (int n = 0; n < n_normals; ++n) {
            const double turn = node.normal(n).dot(node.normal(0));
            const double overlap = node.side[0].reach[n] + node.side[1].reach[n];
            if (!(turn > 0))
                continue;
            if (overlap <= 0)
                return Vec3::Zero();
            const double compared = overlap / turn * (n == 0 ? 1 : much_less);
            if (compared >= least)
                continue;
            least = compared;
            best = node.normal(n);
        }
        return best;
    }

    void start_sweep() {
        for (Node& node : nodes_) {
            for (Side& side : node.side) {
                side.momentum = Vec3p{};
                side.reach = Vec3p{} - infinity;
            }
            node.dv.fill(Vec3p{});
        }
    }

    /// Returns whether they meet there.
    static bool exchange(Node& node, const Friction& friction) {
        const auto& [a, b] = node.side;
        const Vec3 normal = least_overlap(node);
        const Vec3 relative = unpadded(a.momentum / a.mass - b.momentum / b.mass);
        const double approach = relative.dot(normal);
        if (approach <= 0)
            return false;
        Vec3 change = approach * normal;
        const Vec3 slip = relative - change;
        const double speed = slip.norm();
        if (speed > 0)
            change +=
                (friction.stick ? 1.0 : std::min(1.0, friction.coefficient * approach / speed))
                * slip;
        const double reduced_mass = a.mass * b.mass / (a.mass + b.mass);
        node.dv[0] = padded(-reduced_mass / a.mass * change);
        node.dv[1] = padded(reduced_mass / b.mass * change);
        return true;
    }

    const ContactFields& fields_;
    Friction friction_;
    std::array<std::vector<Share>, 2> shares_;
    std::vector<Node> nodes_;
};

GridContact::GridContact(const std::vector<GridPair>& pairs, const ContactFields& corners)
    : fields_(corners) {
    for (const GridPair& pair : pairs) {
        const PaddedBounds where = common(bounds_of(pair.first, corners.x),
                                          bounds_of(pair.second, corners.x),
                                          pair.cell_size);
        if (where.is_empty())
            continue;
        Pair made(pair, fields_, where);
        if (made.is_empty())
            continue;
        made.list_corners(corners_);
        pairs_.push_back(std::move(made));
    }
    std::sort(corners_.begin(), corners_.end());
    corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
}

GridContact::~GridContact() = default;

bool GridContact::is_empty() const {
    return pairs_.empty();
}

bool GridContact::exchange(const Field& x, double dt, Field& velocity) {
    bool have_met = false;
    for (Pair& pair : pairs_)
        for (int k = 0; k < contact_sweeps && pair.sweep(x, dt, velocity); ++k)
            have_met = true;
    return have_met;
}

}  // namespace sim
