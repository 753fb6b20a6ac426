#include "sim/contact/grid_contact.h"

#include "sim/grid/kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace sim {

namespace {

constexpr int contact_sweeps = 3;
constexpr double seen_cells =
    2.5;                      // a node is up to one off a body, and sees the other for 1.5
constexpr int n_normals = 3;  // of both bodies together, and of each
constexpr double much_less = 2;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Bounds {
    Vec3p low{}, high{};
};

/// The eight nodes of a corner's cell, and its weights there.
struct Stencil {
    std::array<int, 8> node{};
    std::array<double, 8> weight{};
};

/// One body's share of a node.
struct Side {
    double mass = 0;
    double volume = 0;       // [m³]
    Vec3 gradient{0, 0, 0};  // of the volume [m²]
    Vec3 momentum{0, 0, 0};
    std::array<double, n_normals> reach{};  // largest distance along each normal, outward
};

struct Node {
    std::array<Side, 2> side;
    std::array<Vec3, n_normals> normals;  // from the first body to the second
    std::array<Vec3, 2> dv{Vec3::Zero(), Vec3::Zero()};

    bool is_shared() const { return side[0].mass > 0 && side[1].mass > 0; }
};

Bounds bounds_of(const ContactBody& body, const Field& x, const Field& velocity, double dt) {
    Bounds bounds{x[body.begin], x[body.begin]};
    for (int c = body.begin; c < body.end; ++c)
        for (const Vec3p& p : {x[c], x[c] + dt * velocity[c]}) {
            bounds.low = p < bounds.low ? p : bounds.low;
            bounds.high = p > bounds.high ? p : bounds.high;
        }
    return bounds;
}

/// The part of space where both bodies can be, and all corners that a node there may see.
Bounds common(const Bounds& a, const Bounds& b, double cell_size) {
    const double margin = seen_cells * cell_size;
    return {(a.low > b.low ? a.low : b.low) - margin,
            (a.high < b.high ? a.high : b.high) + margin};
}

bool is_empty(const Bounds& bounds) {
    return bounds.low[0] > bounds.high[0] || bounds.low[1] > bounds.high[1]
           || bounds.low[2] > bounds.high[2];
}

bool holds(const Bounds& bounds, const Vec3p& x) {
    for (int k = 0; k < 3; ++k)
        if (x[k] < bounds.low[k] || x[k] > bounds.high[k])
            return false;
    return true;
}

/// Nodes of the common part of two bodies, numbered as they are met.
class PairGrid {
  public:
    PairGrid(const ContactBody& a,
             const ContactBody& b,
             const ContactFields& fields,
             const Bounds& where,
             double h)
        : fields_(fields), h_(h) {
        for (const ContactBody* body : {&a, &b}) {
            const int s = body == &b;
            for (int c = body->begin; c < body->end; ++c)
                if (holds(where, fields.x[c])) {
                    corners_[s].push_back(c);
                    stencils_[s].push_back(stencil(fields.x[c]));
                }
            add_mass(s);
        }
        for (int s = 0; s < 2; ++s)
            for (const int c : corners_[s])
                add_gradient(s, c);
        for (Node& node : nodes_)
            if (node.is_shared())
                find_normals(node);
    }

    void sweep(double dt, const Friction& friction, Field& velocity) {
        start_sweep();
        for_shares([&](int s, int c, double weight, Node& node) {
            Side& side = node.side[s];
            side.momentum += weight * fields_.mass[c][0] * unpadded(velocity[c]);
            const Vec3 x = unpadded(fields_.x[c] + dt * velocity[c]);
            for (int n = 0; n < n_normals; ++n)
                side.reach[n] =
                    std::max(side.reach[n],
                             (s == 0 ? 1 : -1) * node.normals[n].dot(x) - fields_.outside[c]);
        });
        for (Node& node : nodes_)
            if (node.is_shared())
                exchange(node, friction);
        for_shares([&](int s, int c, double weight, Node& node) {
            velocity[c] += padded(weight * node.dv[s]) * fields_.is_free[c];
        });
    }

  private:
    Stencil stencil(const Vec3p& x) {
        Stencil result;
        const auto [base, t] = place(x, 0);
        for (int a = 0; a < 8; ++a) {
            std::array<long, 3> key = base;
            double weight = 1;
            for (int k = 0; k < 3; ++k) {
                const int side = a >> k & 1;
                weight *= side ? t[k] : 1 - t[k];
                key[k] += side;
            }
            const auto [entry, is_new] =
                number_of_.try_emplace(packed(key), static_cast<int>(nodes_.size()));
            if (is_new)
                nodes_.emplace_back();
            result.weight[a] = weight;
            result.node[a] = entry->second;
        }
        return result;
    }

    /// The lowest node of a stencil, and the distance from it in cells.
    std::pair<std::array<long, 3>, Vec3p> place(const Vec3p& x, double shift) const {
        std::array<long, 3> base{};
        Vec3p t{};
        for (int k = 0; k < 3; ++k) {
            const double scaled = x[k] / h_, low = std::floor(scaled - shift);
            base[k] = static_cast<long>(low);
            t[k] = scaled - low;
        }
        return {base, t};
    }

    static std::uint64_t packed(const std::array<long, 3>& key) {
        constexpr long half = 1 << 20;  // 21 bits per axis
        return (static_cast<std::uint64_t>(key[0] + half) << 42)
               ^ (static_cast<std::uint64_t>(key[1] + half) << 21)
               ^ static_cast<std::uint64_t>(key[2] + half);
    }

    void add_mass(int s) {
        for (std::size_t k = 0; k < corners_[s].size(); ++k)
            for (int a = 0; a < 8; ++a)
                nodes_[stencils_[s][k].node[a]].side[s].mass +=
                    stencils_[s][k].weight[a] * fields_.mass[corners_[s][k]][0];
    }

    /// By quadratic splines: the slope of a linear one jumps where a corner passes a node, and a lattice that lies on the
    /// grid does so at every breath.
    void add_gradient(int s, int c) {
        using Quadratic = Spline<2>;
        const auto [base, t] = place(fields_.x[c], Quadratic::shift);
        Vec3p w[Quadratic::n], slope[Quadratic::n];
        Quadratic::weights(t, w);
        Quadratic::slopes(t, slope);
        const double scale = fields_.volume[c] / h_;
        for (int i = 0; i < Quadratic::n; ++i)
            for (int j = 0; j < Quadratic::n; ++j)
                for (int k = 0; k < Quadratic::n; ++k) {
                    const auto found =
                        number_of_.find(packed({base[0] + i, base[1] + j, base[2] + k}));
                    if (found == number_of_.end())
                        continue;
                    Side& side = nodes_[found->second].side[s];
                    side.volume += fields_.volume[c] * w[i][0] * w[j][1] * w[k][2];
                    side.gradient += scale
                                     * Vec3(slope[i][0] * w[j][1] * w[k][2],
                                            w[i][0] * slope[j][1] * w[k][2],
                                            w[i][0] * w[j][1] * slope[k][2]);
                }
    }

    /// A weight grows as its corner nears the node: on the whole out of the body. At its rim the gradient of a body leans to
    /// its side. Where rims of both meet their mean does not; where only one ends, the other knows the face that they share.
    static void find_normals(Node& node) {
        const auto& [a, b] = node.side;
        const Vec3 out_of_first = a.gradient / a.volume, into_second = -b.gradient / b.volume;
        node.normals = {out_of_first + into_second, out_of_first, into_second};
        for (Vec3& n : node.normals)
            n = n.norm() > 0 ? n.normalized() : Vec3::Zero();
    }

    /// The mean normal, or that of one body along which they overlap by much less than by the turn from one to the other
    /// alone. Zero where they do not overlap along one of them, for then a plane parts them.
    static Vec3 least_overlap(const Node& node) {
        Vec3 best = Vec3::Zero();
        double least = infinity;
        for (int n = 0; n < n_normals; ++n) {
            const double turn = node.normals[n].dot(node.normals[0]);
            const double overlap = node.side[0].reach[n] + node.side[1].reach[n];
            if (!(turn > 0))
                continue;
            if (overlap <= 0)
                return Vec3::Zero();
            const double compared = overlap / turn * (n == 0 ? 1 : much_less);
            if (compared >= least)
                continue;
            least = compared;
            best = node.normals[n];
        }
        return best;
    }

    void start_sweep() {
        for (Node& node : nodes_) {
            for (Side& side : node.side) {
                side.momentum = Vec3::Zero();
                side.reach.fill(-infinity);
            }
            node.dv.fill(Vec3::Zero());
        }
    }

    /// Of every corner in the nodes that both bodies share.
    template <class Visit>
    void for_shares(const Visit& visit) {
        for (int s = 0; s < 2; ++s)
            for (std::size_t k = 0; k < corners_[s].size(); ++k)
                for (int a = 0; a < 8; ++a) {
                    const double weight = stencils_[s][k].weight[a];
                    Node& node = nodes_[stencils_[s][k].node[a]];
                    if (weight > 0 && node.is_shared())
                        visit(s, corners_[s][k], weight, node);
                }
    }

    static void exchange(Node& node, const Friction& friction) {
        const auto& [a, b] = node.side;
        const Vec3 normal = least_overlap(node);
        const Vec3 relative = a.momentum / a.mass - b.momentum / b.mass;
        const double approach = relative.dot(normal);
        if (approach <= 0)
            return;
        Vec3 change = approach * normal;
        const Vec3 slip = relative - change;
        const double speed = slip.norm();
        if (speed > 0)
            change +=
                (friction.stick ? 1.0 : std::min(1.0, friction.coefficient * approach / speed))
                * slip;
        const double reduced_mass = a.mass * b.mass / (a.mass + b.mass);
        node.dv[0] = -reduced_mass / a.mass * change;
        node.dv[1] = reduced_mass / b.mass * change;
    }

    const ContactFields& fields_;
    double h_ = 0;
    std::array<std::vector<int>, 2> corners_;
    std::array<std::vector<Stencil>, 2> stencils_;
    std::unordered_map<std::uint64_t, int> number_of_;
    std::vector<Node> nodes_;
};

}  // namespace

void exchange_on_grid(const std::vector<GridPair>& pairs,
                      const ContactFields& corners,
                      double dt,
                      Field& velocity) {
    for (const auto& [first, second, cell_size, friction] : pairs) {
        const Bounds where = common(bounds_of(first, corners.x, velocity, dt),
                                    bounds_of(second, corners.x, velocity, dt),
                                    cell_size);
        if (is_empty(where))
            continue;
        PairGrid grid(first, second, corners, where, cell_size);
        for (int k = 0; k < contact_sweeps; ++k)
            grid.sweep(dt, friction, velocity);
    }
}

}  // namespace sim
