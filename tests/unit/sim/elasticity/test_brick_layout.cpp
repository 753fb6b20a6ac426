#include "sim/elasticity/brick_layout.h"
#include "tests/support/box_body.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>
#include <set>

namespace {

sim::BrickLayout layout_of(const sim::Lattice& lattice) {
    std::vector<int> all(lattice.n_domains());
    std::iota(all.begin(), all.end(), 0);
    return sim::best_brick_layout(lattice, all);
}

/// Corners of the domain in a lane, as the kernels of bricks find them: 1, 3, 5, 7 after 0, 2, 4, 6.
std::set<int> corners_in_rows(const sim::BrickLayout& layout,
                              const sim::Batch& batch,
                              int lane) {
    std::set<int> corners;
    for (const int place : batch.row)
        for (const int next : {0, 1})
            corners.insert(layout.corner.at(place + lane + next));
    return corners;
}

}  // namespace

TEST_CASE(
    "a brick has each domain in one lane, its corners in four rows, and each corner once") {
    // A torus: rows of many lengths, with gaps.
    const assets::Torus ring{{0, 0, 0}, {0.3, 0.2, 1}, 0.8, 0.25};
    const sim::Lattice lattice = sim::make_lattice(tests::body_of(ring, 0.1));
    const sim::BrickLayout layout = layout_of(lattice);

    std::set<int> domains;
    for (std::size_t b = 0; b < layout.batches.size(); ++b) {
        const sim::Batch& batch = layout.batches[b];
        for (int r = 0; r < 4 && batch.continues; ++r)
            REQUIRE(batch.row[r] == layout.batches.at(b - 1).row[r] + sim::lane_count);
        for (int lane = 0; lane < sim::lane_count; ++lane) {
            const int p = batch.domain[lane];
            if (p < 0)
                continue;
            REQUIRE(domains.insert(p).second);
            const auto& corners = lattice.corners[p];
            REQUIRE(corners_in_rows(layout, batch, lane)
                    == std::set<int>(corners.begin(), corners.end()));
        }
    }
    REQUIRE(static_cast<int>(domains.size()) == lattice.n_domains());
    const std::set<int> met(layout.corner.begin(), layout.corner.end());
    REQUIRE(met.size() == layout.corner.size());
    REQUIRE(static_cast<int>(met.size()) == lattice.n_corners());
}

TEST_CASE("batches of a brick go on from one row to the next where rows are equally long") {
    const sim::Lattice lattice =
        sim::make_lattice(tests::body_of(assets::Box{{0, 0, 0}, {0.5, 0.3, 0.2}}, 0.1));
    const sim::BrickLayout layout = layout_of(lattice);
    // A layer of z has three rows of 5 domains, each with 6 corners: 17 places from the first to the last. Row by row it would
    // take two batches of four each.
    REQUIRE(layout.batches.size() == 2 * ((17 + sim::lane_count - 1) / sim::lane_count));
    REQUIRE(std::count_if(layout.batches.begin(),
                          layout.batches.end(),
                          [](const sim::Batch& batch) { return !batch.continues; })
            == 2);
}
