// Sets of numbers that are joined until no more belong together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace assets {

/// A forest of disjoint sets of 0 ... n - 1. The lowest member is the root, so that nothing depends on the order of joins.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t n) : parent_(n) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    int root(int member) {
        while (parent_[member] != member)
            member = parent_[member] = parent_[parent_[member]];
        return member;
    }

    void join(int a, int b) {
        const auto [low, high] = std::minmax({root(a), root(b)});
        parent_[high] = low;
    }

  private:
    std::vector<int> parent_;
};

}  // namespace assets
