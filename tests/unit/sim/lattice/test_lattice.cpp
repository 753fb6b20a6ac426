#include "assets/base/error.h"
#include "tests/unit/sim/lattice/bodies.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <numeric>
#include <set>

using namespace sim;

namespace {

double total_volume(const Lattice& lattice) {
    double volume = 0;
    for (int p = 0; p < lattice.n_domains(); ++p)
        volume += lattice.domain_volume(p);
    return volume;
}

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Domains with a neighbour across a face that belongs to another region.
int interface_domains(const Lattice& lattice) {
    std::map<std::array<int, 3>, int> region;
    for (int p = 0; p < lattice.n_domains(); ++p)
        region[lattice.cell[p]] = lattice.region[p];
    int count = 0;
    for (const auto& [cell, r] : region) {
        bool at_interface = false;
        for (int face = 0; face < 6; ++face) {
            std::array<int, 3> neighbour = cell;
            neighbour[face / 2] += face % 2 ? 1 : -1;
            const auto found = region.find(neighbour);
            at_interface |= found != region.end() && found->second != r;
        }
        count += at_interface;
    }
    return count;
}

}  // namespace

TEST_CASE("a box whose edges are multiples of s is cut exactly") {
    const Lattice lattice =
        make_lattice(body(assets::Box{{-0.3, 0.1, 0}, {0.6, 0.5, 0.7}}, 0.1));
    REQUIRE(lattice.n_domains() == 9 * 4 * 7);
    CHECK(lattice.n_corners() == 10 * 5 * 8);
    for (const double fill : lattice.fill)
        CHECK(fill == 1);
    CHECK(total_volume(lattice) == Approx(0.9 * 0.4 * 0.7).epsilon(1e-12));
    CHECK(sum(lattice.corner_volume) == Approx(0.9 * 0.4 * 0.7).epsilon(1e-12));
    CHECK(sum(lattice.corner_mass) == Approx(1000 * 0.9 * 0.4 * 0.7).epsilon(1e-12));
    CHECK(*std::max_element(lattice.corner_outside.begin(), lattice.corner_outside.end())
          < 1e-12);
    CHECK((lattice.corner_rest.front() - Vec3(-0.3, 0.1, 0)).norm() < 1e-12);
    CHECK((lattice.corner_rest.back() - Vec3(0.6, 0.5, 0.7)).norm() < 1e-12);
}

TEST_CASE("corners lie where their coordinates say, once each, in order of z, y, x") {
    const Lattice lattice =
        make_lattice(body(assets::Torus{{0, 0, 0}, {0, 1, 0.3}, 1, 0.3}, 0.1));
    std::set<std::array<int, 3>> used;
    for (int p = 0; p < lattice.n_domains(); ++p)
        for (int a = 0; a < 8; ++a) {
            const std::array<int, 3> expected{lattice.cell[p][0] + (a & 1),
                                              lattice.cell[p][1] + (a >> 1 & 1),
                                              lattice.cell[p][2] + (a >> 2 & 1)};
            CHECK(lattice.corner_cell[lattice.corners[p][a]] == expected);
            used.insert(expected);
        }
    CHECK(static_cast<int>(used.size()) == lattice.n_corners());
    const auto before = [](const std::array<int, 3>& a, const std::array<int, 3>& b) {
        return std::array{a[2], a[1], a[0]} < std::array{b[2], b[1], b[0]};
    };
    CHECK(std::is_sorted(lattice.cell.begin(), lattice.cell.end(), before));
    CHECK(std::is_sorted(lattice.corner_cell.begin(), lattice.corner_cell.end(), before));
    for (int c = 0; c < lattice.n_corners(); ++c) {
        const auto& [x, y, z] = lattice.corner_cell[c];
        CHECK((lattice.corner_rest[c] - lattice.origin - lattice.edge * Vec3(x, y, z)).norm()
              < 1e-12);
    }
}

TEST_CASE("a box that s does not divide is centred and keeps its volume") {
    const Lattice lattice = make_lattice(body(assets::Box{{0, 0, 0}, {1, 1, 0.95}}, 0.1));
    CHECK(lattice.n_domains() == 10 * 10 * 10);
    CHECK(lattice.origin.z() == Approx(-0.025));
    // The cut layers are 3/4 full: six of the eight sample planes.
    CHECK(lattice.fill.front() == 0.75);
    CHECK(total_volume(lattice) == Approx(0.95).epsilon(1e-12));
    CHECK(*std::max_element(lattice.corner_outside.begin(), lattice.corner_outside.end())
          == Approx(0.025));
}

TEST_CASE("the volume of a sphere converges") {
    const double exact = 4.0 / 3 * std::acos(-1.0);
    double error_before = 1;
    for (const int across : {6, 12, 24}) {
        const Lattice lattice =
            make_lattice(body(assets::Sphere{{0.1, 0.2, 0.3}, 1}, 2.0 / across));
        const double error = std::abs(total_volume(lattice) / exact - 1);
        CHECK(error < 0.005 * std::pow(12.0 / across, 2));
        CHECK(error < error_before);
        error_before = error;
    }
}

TEST_CASE("the volume of a turned box is right up to one plane of samples") {
    constexpr double s = 0.05, thickness = 0.25, volume = 0.125;
    const double eighth_turn = std::acos(0.0) / 2;
    const auto error = [&](double angle) {
        Body turned = body(assets::Box{{0, 0, 0}, {1, 0.5, thickness}}, s);
        turned.source.transform.rotate = {angle, 0, 2 * angle};
        return std::abs(total_volume(make_lattice(turned)) / volume - 1);
    };
    // Samples fall in planes s / (8 sqrt 2) apart along the box's normal, its worst direction.
    CHECK(error(eighth_turn) < s / 8 / std::sqrt(2.0) / thickness);
    for (const double angle : {0.1, 0.5})
        CHECK(error(angle) < 0.002);  // no planes: errors of samples cancel
}

TEST_CASE("a bar of three segments has the paper's 196 domains at its interfaces") {
    Body bar = body(assets::Box{{0, 0, 0}, {19, 7, 7}}, 1);
    bar.regions.push_back(region("soft", between(6, 13), 1e5));
    const Lattice lattice = make_lattice(bar);
    CHECK(lattice.n_domains() == 931);
    CHECK(interface_domains(lattice) == 196);
    CHECK(lattice.region_volume[1] == Approx(7 * 7 * 7).epsilon(1e-12));
    CHECK(lattice.region_mass[0] == Approx(1000 * 12 * 49).epsilon(1e-12));
}

TEST_CASE("a cube of five layers has the paper's 3872 domains at its interfaces") {
    // Not a round number: region faces fall on domain faces up to rounding only.
    const double s = 1.0 / 22;
    Body cube = body(assets::Box{{0, 0, 0}, {1, 1, 1}}, s);
    cube.regions.push_back(region("soft 1", between(4 * s, 8 * s), 1e5));
    cube.regions.push_back(region("soft 2", between(14 * s, 18 * s), 1e5));
    const Lattice lattice = make_lattice(cube);
    CHECK(lattice.n_domains() == 22 * 22 * 22);
    CHECK(interface_domains(lattice) == 3872);
}

TEST_CASE("a domain that a region boundary cuts takes both materials by their shares") {
    Body bar = body(assets::Box{{0, 0, 0}, {4, 1, 1}}, 1);
    bar.regions.push_back(region("soft", between(-1, 1.25), 1e5));
    bar.regions[1].density = 500;
    const Lattice lattice = make_lattice(bar);
    REQUIRE(lattice.n_domains() == 4);
    CHECK(lattice.region == std::vector<int>{1, 0, 0, 0});
    CHECK(lattice.mu[1] == Approx(0.25 * lame_mu(1e5, 0.3) + 0.75 * lame_mu(1e6, 0.3)));
    CHECK(lattice.lambda[1]
          == Approx(0.25 * lame_lambda(1e5, 0.3) + 0.75 * lame_lambda(1e6, 0.3)));
    CHECK(lattice.density[1] == Approx(0.25 * 500 + 0.75 * 1000));
    CHECK(lattice.region_volume[1] == Approx(1.25));
    CHECK(sum(lattice.corner_mass) == Approx(1.25 * 500 + 2.75 * 1000));
    CHECK(sum(lattice.region_mass) == Approx(sum(lattice.corner_mass)));
}

TEST_CASE("Lamé parameters meet the bulk and shear moduli") {
    const double mu = lame_mu(1e6, 0.3), lambda = lame_lambda(1e6, 0.3);
    CHECK(lambda + 2 * mu / 3 == Approx(1e6 / (3 * (1 - 2 * 0.3))));   // bulk modulus
    CHECK(mu * (3 * lambda + 2 * mu) / (lambda + mu) == Approx(1e6));  // Young's modulus
}

TEST_CASE("corners of a plane's side are selected whatever the rounding") {
    const Body bar = body(assets::Box{{0, 0, 0}, {0.7, 0.3, 0.3}}, 0.1);
    const Lattice lattice = make_lattice(bar);
    for (int i = 0; i <= 7; ++i) {
        const double x = i / 10.0;
        CHECK(
            select_corners(lattice, bar, {Selector::HalfSpace{{x, 0, 0}, {2, 0, 0}}, {}}).size()
            == (i + 1) * 16u);
        CHECK(select_corners(lattice, bar, box({x, -1, -1}, {1, 1, 1})).size()
              == (8 - i) * 16u);
    }
    CHECK(select_corners(lattice, bar, {Selector::Depth{0}, {}}).size() == 8 * 16 - 6 * 4u);
}

TEST_CASE("selecting no corner is an error that names the key and the body's extent") {
    const Body bar = body(assets::Box{{0, 0, 0}, {4, 1, 1}}, 1);
    const Lattice lattice = make_lattice(bar);
    try {
        select_corners(lattice, bar, {assets::Box{{5, 0, 0}, {6, 1, 1}}, "pin.wall.select"});
        FAIL("no error");
    } catch (const assets::Error& error) {
        CHECK(error.kind() == assets::ErrorKind::Input);
        CHECK(error.key() == "pin.wall.select");
        CHECK_THAT(error.what(), Catch::Contains("[0, 0, 0] to [4, 1, 1]"));
    }
}

TEST_CASE("a unit slip in the domain size is an error, not an exhausted machine") {
    try {
        make_lattice(body(assets::Box{{0, 0, 0}, {1, 1, 1}}, 1e-5));
        FAIL("no error");
    } catch (const assets::Error& error) {
        CHECK(error.key() == "body.b.domain_size");
    }
}

TEST_CASE("the lattice is the same for any number of threads") {
    Body ball = body(assets::Sphere{{0, 0, 0}, 1}, 0.07);
    ball.regions.push_back(region("core", {assets::Sphere{{0.1, 0, 0}, 0.5}, {}}, 1e5));
    const Lattice with_all = make_lattice(ball);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Lattice with_one = make_lattice(ball);
    CHECK(with_all.cell == with_one.cell);
    CHECK(with_all.corners == with_one.corners);
    CHECK(with_all.fill == with_one.fill);
    CHECK(with_all.mu == with_one.mu);
    CHECK(with_all.corner_mass == with_one.corner_mass);
    CHECK(with_all.region_mass == with_one.region_mass);
}
