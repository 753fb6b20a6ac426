#include "sim/contact/grid_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace sim {

namespace {

constexpr int contact_sweeps = 3;

struct Bounds {
    Vec3p low{}, high{};
};

/// The shape of one corner on the grid: its eight nodes, weights and weight gradients.
struct Stencil {
    std::array<int, 8> node{};
    std::array<double, 8> weight{};
    std::array<Vec3, 8> gradient;
};

/// One body's share of a node.
struct Side {
    double mass = 0;
    Vec3 momentum{0, 0, 0}, weight_gradient{0, 0, 0};
    double reach =
        -std::numeric_limits<double>::infinity();  // largest distance along the outward normal
};

struct Node {
    std::array<Side, 2> side;
    Vec3 normal{0, 0, 0};  // from the first body to the second
    std::array<Vec3, 2> dv{Vec3::Zero(), Vec3::Zero()};
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

/// The part of space where both bodies can be, a cell around it included; empty where low > high.
Bounds common(const Bounds& a, const Bounds& b, double cell_size) {
    return {(a.low > b.low ? a.low : b.low) - cell_size,
            (a.high < b.high ? a.high : b.high) + cell_size};
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
            std::vector<int>& list = corners_[body == &b];
            for (int c = body->begin; c < body->end; ++c)
                if (holds(where, fields.x[c]))
                    list.push_back(c);
            for (const int c : list)
                stencils_[body == &b].push_back(stencil(unpadded(fields.x[c])));
        }
    }

    void sweep(double dt, const Friction& friction, Field& velocity) {
        nodes_.assign(n_nodes_, Node{});
        deposit(velocity);
        for (Node& node : nodes_)
            node.normal = normal(node);
        find_reach(dt, velocity);
        for (Node& node : nodes_)
            exchange(node, friction);
        for (int s = 0; s < 2; ++s)
            for (std::size_t k = 0; k < corners_[s].size(); ++k) {
                Vec3 dv = Vec3::Zero();
                for (int a = 0; a < 8; ++a)
                    dv += stencils_[s][k].weight[a] * nodes_[stencils_[s][k].node[a]].dv[s];
                velocity[corners_[s][k]] += padded(dv) * fields_.is_free[corners_[s][k]];
            }
    }

  private:
    Stencil stencil(const Vec3& x) {
        Stencil result;
        const Vec3 scaled = x / h_;
        const Vec3 base = scaled.array().floor();
        const Vec3 t = scaled - base;
        for (int a = 0; a < 8; ++a) {
            Vec3 w, slope;
            std::array<long, 3> key;
            for (int k = 0; k < 3; ++k) {
                const int side = a >> k & 1;
                w[k] = side ? t[k] : 1 - t[k];
                slope[k] = (side ? 1 : -1) / h_;
                key[k] = static_cast<long>(base[k]) + side;
            }
            result.weight[a] = w.prod();
            result.gradient[a] = {
                slope[0] * w[1] * w[2], w[0] * slope[1] * w[2], w[0] * w[1] * slope[2]};
            result.node[a] = number(key);
        }
        return result;
    }

    int number(const std::array<long, 3>& key) {
        constexpr long half = 1 << 20;  // 21 bits per axis
        const std::uint64_t packed = (static_cast<std::uint64_t>(key[0] + half) << 42)
                                     ^ (static_cast<std::uint64_t>(key[1] + half) << 21)
                                     ^ static_cast<std::uint64_t>(key[2] + half);
        const auto [entry, is_new] = number_of_.try_emplace(packed, n_nodes_);
        n_nodes_ += is_new;
        return entry->second;
    }

    void deposit(const Field& velocity) {
        for (int s = 0; s < 2; ++s)
            for (std::size_t k = 0; k < corners_[s].size(); ++k) {
                const int c = corners_[s][k];
                const double mass = fields_.mass[c][0];
                for (int a = 0; a < 8; ++a) {
                    Side& side = nodes_[stencils_[s][k].node[a]].side[s];
                    const double share = stencils_[s][k].weight[a] * mass;
                    side.mass += share;
                    side.momentum += share * unpadded(velocity[c]);
                    side.weight_gradient += mass * stencils_[s][k].gradient[a];
                }
            }
    }

    /// From the first body to the second. A weight grows as its corner nears the node: on the whole out of the body.
    static Vec3 normal(const Node& node) {
        const auto& [a, b] = node.side;
        if (a.mass <= 0 || b.mass <= 0)
            return Vec3::Zero();
        const Vec3 n = a.weight_gradient / a.mass - b.weight_gradient / b.mass;
        const double length = n.norm();
        return length > 0 ? Vec3(n / length) : Vec3::Zero();
    }

    void find_reach(double dt, const Field& velocity) {
        for (int s = 0; s < 2; ++s)
            for (std::size_t k = 0; k < corners_[s].size(); ++k) {
                const int c = corners_[s][k];
                const Vec3 x = unpadded(fields_.x[c] + dt * velocity[c]);
                for (int a = 0; a < 8; ++a) {
                    if (stencils_[s][k].weight[a] <= 0)
                        continue;
                    Node& node = nodes_[stencils_[s][k].node[a]];
                    const double along =
                        (s == 0 ? 1 : -1) * node.normal.dot(x) - fields_.outside[c];
                    node.side[s].reach = std::max(node.side[s].reach, along);
                }
            }
    }

    static void exchange(Node& node, const Friction& friction) {
        const auto& [a, b] = node.side;
        if (a.mass <= 0 || b.mass <= 0 || node.normal.isZero() || a.reach + b.reach <= 0)
            return;
        const Vec3 relative = a.momentum / a.mass - b.momentum / b.mass;
        const double approach = relative.dot(node.normal);
        if (approach <= 0)
            return;
        Vec3 change = approach * node.normal;
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
    int n_nodes_ = 0;
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
