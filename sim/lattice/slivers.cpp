#include "sim/lattice/slivers.h"

#include <algorithm>
#include <bit>
#include <map>

namespace sim {

namespace {

constexpr double least_filled = 0.05 * samples_per_cube;

bool is_sliver(const FilledCube& cube) {
    return !cube.shape && cube.filled < least_filled;
}

/// The region with the largest share, as in the lattice.
int main_region(const FilledCube& cube) {
    const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
    return std::max_element(cube.samples.begin(), cube.samples.end(), less)->first;
}

/// A cube beside another: how many samples of their common face are in the body on both sides.
struct Neighbour {
    int cube = -1, face = 0, n_shared = 0;
};

class Joining {
  public:
    explicit Joining(std::vector<FilledCube>& cubes) : cubes_(cubes) {
        for (std::size_t p = 0; p < cubes.size(); ++p)
            if (!cubes[p].shape)
                at_[cubes[p].cell] = static_cast<int>(p);
    }

    /// What each sliver is given to; of others, and of those that stay, `cube` is -1.
    std::vector<Neighbour> targets() const {
        std::vector<Neighbour> result(cubes_.size());
        std::vector<int> held;
        for (std::size_t p = 0; p < cubes_.size(); ++p) {
            if (!is_sliver(cubes_[p]))
                continue;
            for (const Neighbour& other : neighbours(cubes_[p]))
                if (!is_sliver(cubes_[other.cube]) && other.n_shared > result[p].n_shared
                    && main_region(cubes_[p]) == main_region(cubes_[other.cube]))
                    result[p] = other;
            if (result[p].cube < 0)
                for (const Neighbour& other : neighbours(cubes_[p]))
                    held.push_back(other.cube);
        }
        for (const int p : held)
            result[p] = {};
        return result;
    }

  private:
    /// Those sampled alike that the material goes on in.
    std::vector<Neighbour> neighbours(const FilledCube& cube) const {
        std::vector<Neighbour> result;
        for (int face = 0; face < 6; ++face) {
            std::array<int, 3> cell = cube.cell;
            cell[face / 2] += face % 2 == 0 ? -1 : 1;
            const auto found = at_.find(cell);
            if (found == at_.end())
                continue;
            const int n_shared =
                std::popcount(cube.faces[face] & cubes_[found->second].faces[face ^ 1]);
            if (n_shared > 0)
                result.push_back({found->second, face, n_shared});
        }
        return result;
    }

    const std::vector<FilledCube>& cubes_;
    std::map<std::array<int, 3>, int> at_;  // of cubes not sampled finely
};

}  // namespace

void join_slivers(std::vector<FilledCube>& cubes) {
    const std::vector<Neighbour> targets = Joining(cubes).targets();
    std::vector<FilledCube> kept;
    for (std::size_t p = 0; p < cubes.size(); ++p) {
        if (targets[p].cube < 0)
            continue;
        const FilledCube& sliver = cubes[p];
        FilledCube& target = cubes[targets[p].cube];
        for (const auto& [region, count] : sliver.samples)
            target.add(region, count);
        Vec3 offset = Vec3::Zero();
        for (int axis = 0; axis < 3; ++axis)
            offset[axis] = samples_per_edge * (sliver.cell[axis] - target.cell[axis]);
        target.moment += sliver.moment + sliver.filled * offset;
    }
    for (std::size_t p = 0; p < cubes.size(); ++p)
        if (targets[p].cube < 0)
            kept.push_back(std::move(cubes[p]));
    cubes = std::move(kept);
}

}  // namespace sim
