#include "assets/mesh/edges.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace assets {

std::vector<EdgeUse> sorted_edge_uses(const std::vector<std::array<int, 3>>& triangles) {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * triangles.size());
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int from = triangles[t][k];
            const int to = triangles[t][(k + 1) % 3];
            uses.push_back({std::min(from, to), std::max(from, to), t, from < to});
        }
    }
    std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    return uses;
}

bool is_closed(const std::vector<std::array<int, 3>>& triangles) {
    bool closed = !triangles.empty();
    const std::vector<EdgeUse> uses = sorted_edge_uses(triangles);
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        closed = closed && edge.size() == 2 && edge[0].forward != edge[1].forward;
    });
    return closed;
}

namespace {

// Hands out the uses that start at a vertex, each once, in the order given.
class Departures {
  public:
    explicit Departures(std::span<const EdgeUse> uses) : uses_(uses), next_(uses.size(), none) {
        for (int i = static_cast<int>(uses.size()) - 1; i >= 0; --i) {
            const auto [first, is_new] = first_.try_emplace(uses[i].from(), i);
            if (!is_new)
                next_[i] = std::exchange(first->second, i);
        }
    }

    const EdgeUse* take(int vertex) {
        const auto first = first_.find(vertex);
        if (first == first_.end() || first->second == none)
            return nullptr;
        const int taken = first->second;
        first->second = next_[taken];
        return &uses_[taken];
    }

  private:
    static constexpr int none = -1;
    std::span<const EdgeUse> uses_;
    std::vector<int> next_;               // the next use from the same vertex
    std::unordered_map<int, int> first_;  // vertex → its first use not handed out
};

}  // namespace

std::vector<std::vector<EdgeUse>> simple_loops(std::span<const EdgeUse> uses) {
    std::vector<std::vector<EdgeUse>> loops;
    Departures departures(uses);
    for (const EdgeUse& start : uses) {
        // Walk on while there is a way; wherever the path meets itself, what lies between is a
        // loop.
        std::vector<EdgeUse> path;
        std::unordered_map<int, size_t> position_in_path{{start.from(), 0}};
        for (const EdgeUse* use = departures.take(start.from()); use != nullptr;
             use = departures.take(use->to())) {
            path.push_back(*use);
            const auto [met, is_new] = position_in_path.try_emplace(use->to(), path.size());
            if (is_new)
                continue;
            const auto loop_begin = path.begin() + static_cast<std::ptrdiff_t>(met->second);
            for (auto it = loop_begin; it + 1 != path.end(); ++it)
                position_in_path.erase(it->to());
            loops.emplace_back(loop_begin, path.end());
            path.erase(loop_begin, path.end());
        }
    }
    return loops;
}

}  // namespace assets
