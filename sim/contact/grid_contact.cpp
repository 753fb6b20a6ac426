#include "sim/contact/grid_contact.h"

#include "sim/base/floor.h"
#include "sim/contact/node_box.h"
#include "sim/contact/padded_bounds.h"
#include "sim/grid/kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace sim {

namespace {

constexpr int most_rounds = 4;
// A node is up to one off a body, and sees the other for 1.5.
constexpr double seen_cells = 2.5;
constexpr int n_normals = 3;  // of both bodies together, and of each
constexpr double much_less = 2;
// Of a body at a node, in corners. One that hardly has a part in it would be held there as if it were all of it.
constexpr double least_share = 0.01;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A corner's share of a node that both bodies share.
struct Share {
    int corner = 0, node = 0;
    double weight = 0;
};

/// The volume of one body at a node.
struct Filled {
    double volume = 0;  // [m³]
    Vec3p gradient{};   // of it [m²]
};

/// One body's share of a node.
struct Side {
    double share = 0;  // Σ w
    double mass = 0;
    Vec3p momentum{};
    Vec3p reach{};  // largest distance along each normal, outward
};

struct Node {
    std::array<Side, 2> side;
    // Out of the first body: entry n of [k] is component k of the n-th.
    std::array<Vec3p, 3> normals;
    bool is_pushed = false;  // in this drift

    bool is_shared() const { return std::min(side[0].share, side[1].share) > least_share; }

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
        : fields_(fields), friction_(pair.friction), cell_size_(pair.cell_size) {
        std::array<std::vector<int>, 2> corners;
        for (int s = 0; s < 2; ++s) {
            const ContactBody& body = s == 0 ? pair.first : pair.second;
            for (int c = body.begin; c < body.end; ++c)
                if (where.holds(fields.x[c]))
                    corners[s].push_back(c);
        }
        NodeBox numbers(where.low, where.high, cell_size_);
        number_shared(corners, numbers);
        if (nodes_.empty())
            return;
        rows_.resize(nodes_.size());
        std::vector<std::array<Filled, 2>> filled(nodes_.size());
        for (int s = 0; s < 2; ++s)
            for (const int c : corners[s]) {
                add_shares(s, c, numbers);
                add_gradient(s, c, numbers, filled);
            }
        for (std::size_t n = 0; n < nodes_.size(); ++n)
            find_normals(filled[n], nodes_[n]);
    }

    bool is_empty() const { return nodes_.empty(); }

    void list_corners(std::vector<int>& corners) const {
        for (const std::vector<Share>& shares : shares_)
            for (const Share& share : shares)
                if (corners.empty() || corners.back() != share.corner)
                    corners.push_back(share.corner);
    }

    void begin_drift() {
        for (Node& node : nodes_)
            node.is_pushed = false;
    }

    /// Adds an impulse wherever the bodies, the pair's number `pair`, would meet that has none yet.
    void add_impulses(int pair,
                      const Field& x,
                      double dt,
                      const Field& v,
                      Impulses& impulses,
                      std::vector<Meeting>& meetings) {
        see(x, dt, v);
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            Node& node = nodes_[n];
            const auto& [a, b] = node.side;
            if (node.is_pushed || !node.is_shared())
                continue;
            const Vec3 normal = least_overlap(node);
            if (!(unpadded(a.momentum / a.mass - b.momentum / b.mass).dot(normal) > 0))
                continue;
            if (rows_[n].last == rows_[n].first)
                rows_[n] = impulses.row_of(shares_of(static_cast<int>(n)));
            const Impulses::Touch touch{normal, 0, cell_size_, friction_};
            const int impulse = impulses.add(touch, rows_[n]);
            if (impulse >= 0)
                meetings.push_back({pair, static_cast<int>(n), impulse, touch});
            node.is_pushed = true;
        }
    }

    std::vector<Impulses::Share> shares_of(int n) {
        std::vector<Impulses::Share> result;
        for (int s = 0; s < 2; ++s) {
            if (at_node_[s].empty())
                sort_shares(s);
            const double outward = s == 0 ? -1 : 1;
            for (int k = first_at_node_[s][n]; k < first_at_node_[s][n + 1]; ++k) {
                const auto& [c, node, weight] = shares_[s][at_node_[s][k]];
                result.push_back(
                    {c, outward * weight * fields_.mass[c][0] / nodes_[n].side[s].mass});
            }
        }
        return result;
    }

  private:
    /// visit(node's number, weight) of the eight nodes of a corner's cell that it has a part in.
    template <class Visit>
    void for_linear(int corner, NodeBox& numbers, const Visit& visit) const {
        const auto [base, t] = place(fields_.x[corner], cell_size_, 0);
        for (int a = 0; a < 8; ++a) {
            const int i = a & 1, j = a >> 1 & 1, k = a >> 2;
            const double weight =
                (i ? t[0] : 1 - t[0]) * (j ? t[1] : 1 - t[1]) * (k ? t[2] : 1 - t[2]);
            if (weight > 0)
                visit(numbers(base[0] + i, base[1] + j, base[2] + k), weight);
        }
    }

    void number_shared(const std::array<std::vector<int>, 2>& corners, NodeBox& numbers) {
        constexpr int of_first = -2;
        for (const int c : corners[0])
            if (fields_.mass[c][0] > 0)
                for_linear(c, numbers, [&](int& n, double) { n = of_first; });
        for (const int c : corners[1])
            if (fields_.mass[c][0] > 0)
                for_linear(c, numbers, [&](int& n, double) {
                    if (n != of_first)
                        return;
                    n = static_cast<int>(nodes_.size());
                    nodes_.emplace_back();
                });
    }

    void add_shares(int s, int c, NodeBox& numbers) {
        for_linear(c, numbers, [&](int n, double weight) {
            if (n < 0)
                return;
            shares_[s].push_back({c, n, weight});
            nodes_[n].side[s].share += weight;
            nodes_[n].side[s].mass += weight * fields_.mass[c][0];
        });
    }

    /// By quadratic splines: the slope of a linear one jumps where a corner passes a node, and a lattice that lies on the
    /// grid does so at every breath.
    void add_gradient(int s,
                      int c,
                      NodeBox& numbers,
                      std::vector<std::array<Filled, 2>>& filled) const {
        using Quadratic = Spline<2>;
        const auto [base, t] = place(fields_.x[c], cell_size_, Quadratic::shift);
        Vec3p w[Quadratic::n], slope[Quadratic::n];
        Quadratic::weights(t, w);
        Quadratic::slopes(t, slope);
        const double volume = fields_.volume[c], scale = volume / cell_size_;
        for (int k = 0; k < Quadratic::n; ++k)
            for (int j = 0; j < Quadratic::n; ++j)
                for (int i = 0; i < Quadratic::n; ++i) {
                    const int n = numbers(base[0] + i, base[1] + j, base[2] + k);
                    if (n < 0)
                        continue;
                    Filled& side = filled[n][s];
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
    static void find_normals(const std::array<Filled, 2>& filled, Node& node) {
        const auto& [a, b] = filled;
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

    void sort_shares(int s) {
        std::vector<int>&first = first_at_node_[s], &sorted = at_node_[s];
        first.assign(nodes_.size() + 2, 0);
        for (const Share& share : shares_[s])
            ++first[share.node + 2];
        std::partial_sum(first.begin(), first.end(), first.begin());
        sorted.resize(shares_[s].size());
        // Each first moves on to where the next node begins.
        for (std::size_t k = 0; k < sorted.size(); ++k)
            sorted[first[shares_[s][k].node + 1]++] = static_cast<int>(k);
    }

    /// Where the bodies would be by the end of the drift.
    void see(const Field& x, double dt, const Field& v) {
        for (Node& node : nodes_)
            for (Side& side : node.side) {
                side.momentum = Vec3p{};
                side.reach = Vec3p{} - infinity;
            }
        for (int s = 0; s < 2; ++s) {
            const double outward = s == 0 ? 1 : -1;
            for (const auto& [c, n, weight] : shares_[s]) {
                Node& node = nodes_[n];
                Side& side = node.side[s];
                side.momentum += weight * fields_.mass[c][0] * v[c];
                const Vec3p end = x[c] + dt * v[c];
                const Vec3p along = node.normals[0] * end[0] + node.normals[1] * end[1]
                                    + node.normals[2] * end[2];
                side.reach = larger(side.reach, outward * along - fields_.outside[c]);
            }
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

    const ContactFields& fields_;
    Friction friction_;
    double cell_size_;
    std::array<std::vector<Share>, 2> shares_;
    std::vector<Node> nodes_;
    // Shares sorted by node, and where those of a node begin; of use where the bodies have met.
    std::array<std::vector<int>, 2> at_node_, first_at_node_;
    std::vector<Impulses::Row> rows_;  // (#nodes) there
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
        if (!made.is_empty())
            pairs_.push_back(std::move(made));
    }
    for (const Pair& pair : pairs_)
        pair.list_corners(corners_);
    std::sort(corners_.begin(), corners_.end());
    corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
}

GridContact::~GridContact() = default;

bool GridContact::is_empty() const {
    return pairs_.empty();
}

bool GridContact::restrain(Impulses& impulses, const Field& x, double dt, Field& q, Field& v) {
    impulses.begin_drift(dt);
    for (Pair& pair : pairs_)
        pair.begin_drift();
    meetings_.clear();
    for (int round = 0; round < most_rounds; ++round) {
        const std::size_t before = meetings_.size();
        for (std::size_t k = 0; k < pairs_.size(); ++k)
            pairs_[k].add_impulses(static_cast<int>(k), x, dt, v, impulses, meetings_);
        if (meetings_.size() == before)
            break;
        impulses.settle(q, corners_, v);
    }
    return !meetings_.empty();
}

std::vector<Impulses::Share> GridContact::shares_of(const Meeting& meeting) {
    return pairs_[meeting.pair].shares_of(meeting.node);
}

}  // namespace sim
