#include "assets/base/error.h"
#include "sim/enrichment/enrichment.h"
#include "sim/enrichment/thin_domains.h"
#include "tests/support/box_body.h"
#include "tests/support/corner_fields.h"
#include "tests/support/random_fields.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <cmath>

namespace {

/// A box of n domains of edge s, cut along `axis` into layers that end at these domain counts, of two materials in turn.
sim::Lattice layered(const std::array<int, 3>& n,
                     double s,
                     int axis,
                     const std::vector<int>& ends) {
    sim::Body body = tests::box_body(n, s);
    for (std::size_t k = 0; k < ends.size(); ++k)
        body.regions.push_back(
            tests::region(k % 2 ? "hard" : "soft",
                          tests::behind(ends[k] * s * Vec3::Unit(axis), -Vec3::Unit(axis)),
                          k % 2 ? 1e6 : 1e5));
    return sim::make_lattice(body);
}

constexpr sim::EnrichmentCriteria interface {
    true, false, false, false
}, thin{false, true, false, false}, mixed_cell{false, false, true, false},
    strain{false, false, false, true};

}  // namespace

TEST_CASE("boundary domains are counted as in the paper's table") {
    // A bar of 19 × 7 × 7 with segments of 6, 7 and 6: two interfaces, two planes of 49 domains each.
    CHECK(sim::boundary_domains(layered({19, 7, 7}, 0.025, 0, {6, 13})).size() == 196);
    // A cube of 22³ in five layers: four interfaces, two planes of 484 each.
    CHECK(sim::boundary_domains(layered({22, 22, 22}, 0.05, 2, {4, 9, 13, 18})).size() == 3872);
    CHECK(sim::boundary_domains(layered({5, 4, 3}, 0.1, 0, {})).empty());
}

TEST_CASE("boundary domains touch another region face to face, not edge to edge") {
    sim::Body body = tests::box_body({3, 3, 3}, 1);
    body.regions.push_back(
        tests::region("heart", {assets::Box{{1, 1, 1}, {2, 2, 2}}, {}}, 1e5));
    const sim::Lattice lattice = sim::make_lattice(body);
    const std::vector<int> boundary = sim::boundary_domains(lattice);
    CHECK(boundary.size() == 7);
    for (const int p : boundary) {
        const auto& cell = lattice.cell[p];
        CHECK(std::abs(cell[0] - 1) + std::abs(cell[1] - 1) + std::abs(cell[2] - 1) <= 1);
    }
}

TEST_CASE("domains with their centre in the cell of a boundary domain's centre are enriched") {
    const double s = 0.1, h = GENERATE(0.2, 0.13, 0.5);
    const Vec3 shift = GENERATE(Vec3(0, 0, 0), Vec3(-7.77, 0.031, 3.003));
    const sim::Lattice lattice = layered({9, 5, 4}, s, 0, {4});
    tests::Random random(1);
    sim::Field corners = tests::corners_at(lattice);
    for (sim::Vec3p& x : corners)
        x += sim::padded(shift + tests::random_vector(random, 0.02));

    std::vector<char> free(corners.size(), 0), expected_free(corners.size(), 0);
    free[3] = expected_free[3] = 1;  // as a pin would have it
    sim::Enrichment enrichment(lattice, interface, h);
    enrichment.update(lattice, corners.data(), free.data());

    const auto centre_cell = [&](int p) {
        Vec3 centre = Vec3::Zero();
        for (const int c : lattice.corners[p])
            centre += sim::unpadded(corners[c]) / 8;
        return Vec3((centre / h).array().floor());
    };
    const std::vector<int> boundary = sim::boundary_domains(lattice);
    int n_enriched = 0;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        bool expected = false;
        for (const int q : boundary)
            expected |= centre_cell(p) == centre_cell(q);
        REQUIRE(bool(enrichment.enriched()[p]) == expected);
        n_enriched += expected;
        for (const int c : lattice.corners[p])
            expected_free[c] |= expected;
    }
    CHECK(free == expected_free);
    CHECK(n_enriched >= int(boundary.size()));
    CHECK(n_enriched < lattice.n_domains());
}

TEST_CASE("a body of one material is never enriched") {
    const sim::Lattice lattice = layered({3, 1, 1}, 0.1, 0, {});
    const sim::Field corners = tests::corners_at(lattice);
    std::vector<char> free(corners.size(), 0);
    sim::Enrichment enrichment(lattice, interface, 0.2);
    enrichment.update(lattice, corners.data(), free.data());
    CHECK(free == std::vector<char>(corners.size(), 0));
    CHECK(enrichment.enriched() == std::vector<char>(3, 0));
}

TEST_CASE("a layered body that has flown apart is an error") {
    const sim::Lattice lattice = layered({2, 1, 1}, 0.1, 0, {1});
    sim::Field corners = tests::corners_at(lattice);
    corners[0] = sim::Vec3p{1e300, 0, 0, 0};
    std::vector<char> free(corners.size(), 0);
    sim::Enrichment enrichment(lattice, interface, 0.2);
    CHECK_THROWS_AS(enrichment.update(lattice, corners.data(), free.data()), assets::Error);
}

TEST_CASE("mixed_cell enriches where a cell holds two regions that are no neighbours") {
    // One hard domain in a corner of a soft body with a gap around it: no face in common.
    sim::Body body = tests::box_body({4, 2, 2}, 1);
    body.regions.push_back(tests::region("hard", {assets::Box{{3, 1, 1}, {4, 2, 2}}, {}}, 1e6));
    sim::Lattice lattice = sim::make_lattice(body);
    // Take its face neighbours out of the lattice: those whose cells differ from (3,1,1) along one axis.
    for (int p = lattice.n_domains() - 1; p >= 0; --p) {
        const auto& cell = lattice.cell[p];
        if (std::abs(cell[0] - 3) + std::abs(cell[1] - 1) + std::abs(cell[2] - 1) != 1)
            continue;
        lattice.cell.erase(lattice.cell.begin() + p);
        lattice.corners.erase(lattice.corners.begin() + p);
        lattice.region.erase(lattice.region.begin() + p);
    }
    REQUIRE(sim::boundary_domains(lattice).empty());
    const sim::Field corners = tests::corners_at(lattice);
    const auto n_enriched = [&](const sim::EnrichmentCriteria& criteria) {
        std::vector<char> free(corners.size(), 0);
        sim::Enrichment enrichment(lattice, criteria, 2.0);  // cells [0,2) and [2,4) along x
        enrichment.update(lattice, corners.data(), free.data());
        int n = 0;
        for (int p = 0; p < lattice.n_domains(); ++p) {
            n += enrichment.enriched()[p];
            CHECK(enrichment.enriched()[p] <= (lattice.cell[p][0] >= 2));
        }
        return n;
    };
    CHECK(n_enriched(interface) == 0);
    CHECK(n_enriched(mixed_cell) == 5);  // 8 in the right cell without three neighbours
}

TEST_CASE("thin parts are those that no cube of three cells fits into") {
    const int thickness = GENERATE(3, 4, 6, 7, 8);
    const double depth = GENERATE(1.0, 1.5, 2.0, 3.0, 4.0);  // domain edges
    CAPTURE(thickness, depth);
    const sim::Lattice lattice = layered({12, thickness, 12}, 0.1, 0, {});
    const bool expected = thickness < 2 * std::ceil(depth);  // cubes of whole domains
    const std::vector<char> is_thin = sim::thin_domains(lattice, depth);
    CHECK(is_thin == std::vector<char>(lattice.n_domains(), expected));

    sim::Enrichment enrichment(lattice, thin, 0.1 * depth / 1.5);
    std::vector<char> free(lattice.n_corners(), 0);
    enrichment.update(lattice, tests::corners_at(lattice).data(), free.data());
    CHECK(enrichment.enriched() == is_thin);
    CHECK(free == std::vector<char>(lattice.n_corners(), expected));
}

TEST_CASE("a fin on a block is thin but where it grows out of it, a ball nowhere") {
    const double depth = 4;
    sim::Body body = tests::box_body({8, 8, 8}, 1);
    const auto boxes = [](const assets::Box& block, const assets::Box& fin) {
        return assets::Combination{assets::Combination::Kind::Union, {{block}, {fin}}, 0};
    };
    body.source.geometry = boxes({{0, 0, 0}, {8, 8, 8}}, {{4, 3, 0}, {20, 5, 8}});
    const sim::Lattice finned = sim::make_lattice(body);
    const std::vector<char> is_thin = sim::thin_domains(finned, depth);
    for (int p = 0; p < finned.n_domains(); ++p) {
        // The block has one corner 4 deep, in its middle; 6 is one and a half times as far.
        const bool expected = finned.cell[p][0] - finned.cell.front()[0] > 4 + 6;
        REQUIRE(bool(is_thin[p]) == expected);
    }

    body.source.geometry = assets::Sphere{{0, 0, 0}, 9.3};
    const sim::Lattice ball = sim::make_lattice(body);
    CHECK(sim::thin_domains(ball, depth) == std::vector<char>(ball.n_domains(), 0));
}

TEST_CASE("strain enriches squashed domains until they have recovered by a margin") {
    const sim::Lattice lattice = layered({1, 1, 1}, 1, 0, {});
    sim::Enrichment enrichment(lattice, strain, 2.0);
    const auto enriched_at = [&](const Vec3& stretch) {
        sim::Field corners = tests::corners_at(lattice);
        const Mat3 R = Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
        for (sim::Vec3p& x : corners)
            x = sim::padded(R * stretch.cwiseProduct(sim::unpadded(x)));
        std::vector<char> free(corners.size(), 0);
        enrichment.update(lattice, corners.data(), free.data());
        CHECK(free == std::vector<char>(8, enrichment.enriched()[0]));
        return bool(enrichment.enriched()[0]);
    };
    CHECK_FALSE(enriched_at({1, 1, 1}));
    CHECK_FALSE(enriched_at({1, 0.55, 1}));
    CHECK(enriched_at({1, 0.49, 1}));
    CHECK(enriched_at({1, 0.55, 1}));  // not yet
    CHECK_FALSE(enriched_at({1, 0.61, 1}));
    CHECK(enriched_at({3, 1, 1}));  // 1/3 of the largest
    CHECK(enriched_at({2.5, 1, 1}));
    CHECK_FALSE(enriched_at({2, 1, 1}));
}

TEST_CASE("a domain near the border of a marked cell does not flicker") {
    // Two domains, of two regions; the second one's centre swings around the border of the first one's cell.
    const sim::Lattice lattice = layered({4, 1, 1}, 1, 0, {1});
    sim::Enrichment enrichment(lattice, interface, 2.0);
    const auto enriched_at = [&](double shift) {
        sim::Field corners = tests::corners_at(lattice);
        for (sim::Vec3p& x : corners)
            x[0] += shift;
        std::vector<char> free(corners.size(), 0);
        enrichment.update(lattice, corners.data(), free.data());
        return enrichment.enriched();
    };
    using Flags = std::vector<char>;
    CHECK(enriched_at(0)
          == Flags{1, 1, 0, 0});  // centres 0.5, 1.5 | 2.5, 3.5; boundary: the first two
    CHECK(enriched_at(0.6) == Flags{1, 1, 1, 0});  // 1.1 | 2.1, 3.1 | 4.1
    CHECK(
        enriched_at(0.4)
        == Flags{
            1, 1, 1, 0});  // 0.9, 1.9 | 2.9, 3.9: the second is 0.1 from the cell of the third
    CHECK(enriched_at(-0.2)
          == Flags{1, 1, 0, 0});  // 0.3, 1.3 | 2.3: 0.7 away, beyond a quarter of a cell
}
