#include "sim/lattice/slivers.h"
#include "tests/unit/sim/lattice/bodies.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <map>

using sim::Lattice;
using sim::Slivers;

namespace {

constexpr double s = 0.1, least_filled = 0.05;

/// A ball and a smaller one beside it: errors of moments do not cancel, as they do in a ball.
Lattice two_balls(double radius, Slivers slivers) {
    const assets::Sphere big{{0.1, 0.2, 0.3}, radius}, small{{0.5, 0.4, 0.7}, 0.7 * radius};
    const assets::Combination both{assets::Combination::Kind::Union, {{big}, {small}}, 0};
    return sim::make_lattice(body(both, s), nullptr, slivers);
}

Lattice ball(double radius, Slivers slivers) {
    return sim::make_lattice(
        body(assets::Sphere{{0.1, 0.2, 0.3}, radius}, s), nullptr, slivers);
}

struct Sums {
    double volume = 0, mass = 0;
    Vec3 moment = Vec3::Zero();
};

Sums sums_of(const Lattice& lattice) {
    Sums sums;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        const double volume = lattice.domain_volume(p);
        sums.volume += volume;
        sums.mass += volume * lattice.density[p];
        sums.moment += volume * lattice.filled_centre[p];
    }
    return sums;
}

int n_slivers(const Lattice& lattice) {
    int n = 0;
    for (const double fill : lattice.fill)
        n += fill < least_filled;
    return n;
}

}  // namespace

TEST_CASE("of a ball no slivers are left, and nothing else goes") {
    int before = 0;
    for (const double radius : {0.53, 0.62, 0.71}) {
        const Lattice kept = ball(radius, Slivers::Kept),
                      joined = ball(radius, Slivers::Joined);
        before += n_slivers(kept);
        CHECK(n_slivers(joined) == 0);
        CHECK(joined.n_domains() == kept.n_domains() - n_slivers(kept));
    }
    CHECK(before > 20);
}

TEST_CASE("slivers go to their neighbours with all that fills them") {
    for (const double radius : {0.53, 0.62, 0.71}) {
        const Lattice kept = two_balls(radius, Slivers::Kept),
                      joined = two_balls(radius, Slivers::Joined);
        CHECK(joined.n_domains() < kept.n_domains());
        const Sums all = sums_of(joined), expected = sums_of(kept);
        CHECK(all.volume == Approx(expected.volume).epsilon(1e-12));
        CHECK(all.mass == Approx(expected.mass).epsilon(1e-12));
        CHECK((all.moment - expected.moment).norm() < 1e-12);
    }
}

TEST_CASE("domains beside no sliver stay as they were") {
    const Lattice kept = ball(0.62, Slivers::Kept), joined = ball(0.62, Slivers::Joined);
    std::map<std::array<int, 3>, double> fill;
    for (int p = 0; p < kept.n_domains(); ++p)
        fill[kept.cell[p]] = kept.fill[p];
    for (int p = 0; p < joined.n_domains(); ++p) {
        const auto& cell = joined.cell[p];
        CHECK(joined.fill[p] >= fill.at(cell));
        bool has_sliver = false;
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) {
                auto beside = cell;
                beside[axis] += side;
                const auto found = fill.find(beside);
                has_sliver |= found != fill.end() && found->second < least_filled;
            }
        if (!has_sliver)
            CHECK(joined.fill[p] == fill.at(cell));
    }
}

TEST_CASE("corners tell how far the surface is beyond them where a sliver was") {
    const assets::Shape sphere = assets::Sphere{{0.1, 0.2, 0.3}, 0.62};
    const Lattice joined = ball(0.62, Slivers::Joined);
    int n_beyond = 0;
    for (int c = 0; c < joined.n_corners(); ++c) {
        const double distance = assets::signed_distance(sphere, joined.corner_rest[c]);
        if (joined.corner_outside[c] < 0) {
            ++n_beyond;
            CHECK(joined.corner_outside[c] == Approx(distance));
            // What fills a twentieth of a cube under a face reaches to a twentieth of its edge in the mean.
            CHECK(distance > -0.5 * s);
        } else {
            CHECK(joined.corner_outside[c] == Approx(std::max(0.0, distance)));
        }
    }
    CHECK(n_beyond > 0);
}

TEST_CASE("a sliver of another region than what it lies on stays") {
    // The cap of a ball, less than a twentieth of the layer of cubes that it is in.
    sim::Body capped = body(assets::Sphere{{0, 0, 0}, 0.62}, s);
    const Lattice plain = sim::make_lattice(capped, nullptr, Slivers::Kept);
    double top = -1;
    for (const Vec3& X : plain.corner_rest)
        top = std::max(top, X.z());
    capped.regions.push_back(region("cap", box({-1, -1, top - s}, {1, 1, 1}), 1e5));
    const Lattice kept = sim::make_lattice(capped, nullptr, Slivers::Kept),
                  joined = sim::make_lattice(capped, nullptr, Slivers::Joined);
    const auto n_of_cap = [](const Lattice& lattice, bool only_slivers) {
        int n = 0;
        for (int p = 0; p < lattice.n_domains(); ++p)
            n += lattice.region[p] == 1 && (!only_slivers || lattice.fill[p] < least_filled);
        return n;
    };
    CHECK(n_of_cap(kept, true) > 0);
    CHECK(n_of_cap(joined, false) > 0);
    CHECK(sums_of(joined).mass == Approx(sums_of(kept).mass).epsilon(1e-12));
    double volume = 0;
    for (int p = 0; p < joined.n_domains(); ++p)
        if (joined.region[p] == 1)
            volume += joined.domain_volume(p);
    CHECK(volume == Approx(joined.region_volume[1]).epsilon(1e-9));
}
