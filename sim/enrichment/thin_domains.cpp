#include "sim/enrichment/thin_domains.h"

#include <algorithm>
#include <limits>

namespace sim {

namespace {

constexpr double reach = 1.5;      // of a corner as deep as asked for, in depths
constexpr double rounding = 1e-6;  // of the depth, where it is whole
constexpr int unreached = std::numeric_limits<int>::max();

/// Number of domains on the shortest way from the corners where `steps` is 0 to each other one.
class Flood {
  public:
    explicit Flood(const Lattice& lattice)
        : lattice_(lattice), first_(lattice.n_corners() + 1) {
        for (const auto& corners : lattice.corners)
            for (const int c : corners)
                ++first_[c + 1];
        for (int c = 0; c < lattice.n_corners(); ++c)
            first_[c + 1] += first_[c];
        domains_.resize(first_.back());
        std::vector<int> next(first_.begin(), first_.end() - 1);
        for (int p = 0; p < lattice.n_domains(); ++p)
            for (const int c : lattice.corners[p])
                domains_[next[c]++] = p;
    }

    void run(std::vector<int>& steps) const {
        std::vector<int> queue;
        for (int c = 0; c < lattice_.n_corners(); ++c)
            if (steps[c] == 0)
                queue.push_back(c);
        for (std::size_t k = 0; k < queue.size(); ++k)
            for (int i = first_[queue[k]]; i < first_[queue[k] + 1]; ++i)
                for (const int c : lattice_.corners[domains_[i]])
                    if (steps[c] == unreached) {
                        steps[c] = steps[queue[k]] + 1;
                        queue.push_back(c);
                    }
    }

  private:
    const Lattice& lattice_;
    std::vector<int> first_, domains_;  // of corner c: [first_[c], first_[c+1])
};

/// Corners without a domain, filled by half at least, in each of the eight directions.
std::vector<char> outer_corners(const Lattice& lattice) {
    std::vector<unsigned> directions(lattice.n_corners(), 0);
    for (int p = 0; p < lattice.n_domains(); ++p)
        for (int a = 0; a < 8; ++a)
            if (lattice.fill[p] >= 0.5)
                directions[lattice.corners[p][a]] |= 1u << a;
    std::vector<char> is_outer(directions.size());
    std::transform(directions.begin(), directions.end(), is_outer.begin(), [](unsigned seen) {
        return seen != 0xff;
    });
    return is_outer;
}

}  // namespace

std::vector<char> thin_domains(const Lattice& lattice, double depth) {
    const Flood flood(lattice);
    std::vector<int> from_surface;
    for (const char is_outer : outer_corners(lattice))
        from_surface.push_back(is_outer ? 0 : unreached);
    flood.run(from_surface);

    std::vector<int> from_depth;
    for (const int steps : from_surface)
        from_depth.push_back(steps >= depth - rounding ? 0 : unreached);
    flood.run(from_depth);

    std::vector<char> is_thin(lattice.n_domains());
    for (int p = 0; p < lattice.n_domains(); ++p)
        is_thin[p] = std::all_of(lattice.corners[p].begin(),
                                 lattice.corners[p].end(),
                                 [&](int c) { return from_depth[c] > reach * depth; });
    return is_thin;
}

}  // namespace sim
