// Boxes around eight boxes, around eight of those, and so on.
#pragma once

#include "sim/contact/eight_boxes.h"

#include <vector>

namespace sim {

/// Leaf k holds the boxes 8k to 8k + 7, and a node k of each level above those of the eight nodes 8k to 8k + 7 below it.
class BoxTree {
  public:
    /// Empty boxes.
    explicit BoxTree(std::size_t n_boxes) {
        for (std::size_t n = n_boxes; levels_.empty() || n > 1;
             n = levels_.back().eights.size()) {
            const std::size_t n_nodes = (n + EightBoxes::n - 1) / EightBoxes::n;
            levels_.push_back(
                {std::vector<EightBoxes>(n_nodes), std::vector<FloatBox>(n_nodes)});
        }
    }

    int n_levels() const { return static_cast<int>(levels_.size()); }

    int n_leaves() const { return static_cast<int>(levels_.front().eights.size()); }

    /// Until carry_up() what is around it is not known.
    void set(int k, const FloatBox& box) {
        levels_[0].eights[k / EightBoxes::n].set(k % EightBoxes::n, box);
    }

    FloatBox box(int k) const {
        return levels_[0].eights[k / EightBoxes::n].box(k % EightBoxes::n);
    }

    void carry_up() {
        for (std::size_t level = 0; level < levels_.size(); ++level)
            for (std::size_t k = 0; k < levels_[level].eights.size(); ++k) {
                levels_[level].around[k] = levels_[level].eights[k].around();
                if (level + 1 < levels_.size())
                    levels_[level + 1].eights[k / EightBoxes::n].set(k % EightBoxes::n,
                                                                     levels_[level].around[k]);
            }
    }

    /// Of a node: level 0 is that of the leaves.
    const EightBoxes& eight(int level, int node) const { return levels_[level].eights[node]; }

    const FloatBox& around(int level, int node) const { return levels_[level].around[node]; }

    const FloatBox& around() const { return levels_.back().around.front(); }

  private:
    struct Level {
        std::vector<EightBoxes> eights;
        std::vector<FloatBox> around;
    };

    std::vector<Level> levels_;
};

}  // namespace sim
