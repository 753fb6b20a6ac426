#include "assets/base/error.h"
#include "sim/lattice/regions.h"
#include "tests/unit/sim/lattice/bodies.h"

#include <catch2/catch.hpp>

using namespace sim;

namespace {

const Selector left = between(-1, 2), right = between(1, 5);

/// Whether each of x = 0.5, 1.5, 2.5 is selected.
std::string selected(const Selector& select) {
    const Body bar = body(assets::Box{{0, 0, 0}, {3, 1, 1}}, 1);
    LevelMaker maker(bar);
    const Level level = maker.make(select);
    std::string answer;
    for (const double x : {0.5, 1.5, 2.5})
        answer += level({x, 0.5, 0.5}) <= 0 ? '1' : '0';
    return answer;
}

assets::Error error_of(const Body& body) {
    try {
        make_lattice(body);
    } catch (const assets::Error& error) {
        return error;
    }
    FAIL("no error");
    throw;
}

}  // namespace

TEST_CASE("selectors combine like sets") {
    CHECK(selected(all()) == "111");
    CHECK(selected(left) == "110");
    CHECK(selected({Selector::AllOf{{left, right}}, {}}) == "010");
    CHECK(selected({Selector::AnyOf{{left, right}}, {}}) == "111");
    CHECK(selected({Selector::AnyOf{{between(0, 1), between(2, 3)}}, {}}) == "101");
    CHECK(selected({Selector::Not{{left}}, {}}) == "001");
    CHECK(selected({Selector::AllOf{{right, {Selector::Not{{left}}, {}}}}, {}}) == "001");
    CHECK(selected({Selector::HalfSpace{{1, 0, 0}, {-3, 0, 0}}, {}}) == "011");
}

TEST_CASE("levels change no faster than the position moves") {
    const Body ball = body(assets::Sphere{{0, 0, 0}, 1}, 0.1);
    LevelMaker maker(ball);
    const Selector mixed{
        Selector::AllOf{{{Selector::Depth{0.2}, {}}, {Selector::Not{{left}}, {}}}}, {}};
    const Level level = maker.make(mixed);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 X = 1.2 * Vec3::Random(), Y = X + 0.05 * Vec3::Random();
        CHECK(std::abs(level(X) - level(Y)) <= (X - Y).norm() + 1e-12);
    }
}

TEST_CASE("depth selects a shell") {
    Body ball = body(assets::Sphere{{0, 0, 0}, 1}, 0.1);
    ball.regions.push_back(region("shell", {Selector::Depth{0.25}, {}}));
    const Lattice lattice = make_lattice(ball);
    const double share =
        lattice.region_volume[1] / (lattice.region_volume[0] + lattice.region_volume[1]);
    CHECK(share == Approx(1 - 0.75 * 0.75 * 0.75).epsilon(0.005));
}

TEST_CASE("a region that selects nothing is an error with its key") {
    Body bar = body(assets::Box{{0, 0, 0}, {3, 1, 1}}, 1);
    bar.regions.push_back(region("far", between(7, 8)));
    const assets::Error error = error_of(bar);
    CHECK(error.kind() == assets::ErrorKind::Input);
    CHECK(error.key() == "body.b.region.far.select");
    CHECK_THAT(error.what(),
               Catch::Contains("\"far\" selects nothing") && Catch::Contains("[3, 1, 1]"));
}

TEST_CASE("a hidden region is an error that names what hides it") {
    Body bar = body(assets::Box{{0, 0, 0}, {3, 1, 1}}, 1);
    bar.regions.push_back(region("middle", between(1, 2)));
    bar.regions.push_back(region("late", between(0.5, 2.5)));
    CHECK(error_of(bar).key() == "body.b.region.middle.select");
    CHECK_THAT(error_of(bar).what(), Catch::Contains("hidden by region \"late\""));
    bar.regions = {region("first", all()), region("cover", between(-1, 4))};
    CHECK(error_of(bar).key() == "body.b.region.first.select");
}

TEST_CASE("the first region selects all") {
    Body bar = body(assets::Box{{0, 0, 0}, {3, 1, 1}}, 1);
    bar.regions = {region("part", between(1, 2))};
    CHECK_THAT(error_of(bar).what(),
               Catch::Contains("\"part\"") && Catch::Contains("must select \"all\""));
}

TEST_CASE("a mesh material of a shape is an error") {
    Body bar = body(assets::Box{{0, 0, 0}, {3, 1, 1}}, 1);
    bar.regions.push_back(region("muscle", {Selector::MeshMaterial{"Muscle*"}, {}}));
    CHECK(error_of(bar).key() == "body.b.region.muscle.select");
}

TEST_CASE("a region thinner than a domain is noted with both lengths") {
    Body bar = body(assets::Box{{0, 0, 0}, {3, 1, 1}}, 1);
    bar.regions.push_back(region("skin", between(0, 0.25)));
    std::vector<std::string> notes;
    make_lattice(bar, &notes);
    REQUIRE(notes.size() == 1);
    CHECK_THAT(
        notes[0],
        Catch::Contains("\"skin\"") && Catch::Contains("0.25 m") && Catch::Contains("1 m"));
    bar.regions[1] = region("skin", between(0, 0.75));
    notes.clear();
    make_lattice(bar, &notes);
    CHECK(notes.empty());
}

TEST_CASE("shell-style patterns") {
    CHECK(matches("Muscle*", "Muscle.001"));
    CHECK(matches("*", ""));
    CHECK(matches("a?c", "abc"));
    CHECK(matches("*a*b", "xaaxb"));
    CHECK_FALSE(matches("a?c", "ac"));
    CHECK_FALSE(matches("Muscle", "muscle"));
    CHECK_FALSE(matches("*a*b", "xaxbx"));
    CHECK(nearest_word("Musle*", {"Skin", "Muscle", "Bone"}) == "Muscle");
}
