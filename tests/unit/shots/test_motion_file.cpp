// Colliders that follow a motion baked by another program.
#include "assets/base/error.h"
#include "shots/reading/motion_file.h"

#include <catch2/catch.hpp>

#include "shot_text.h"
#include <numbers>

using namespace shots;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

constexpr double degree = std::numbers::pi / 180;

std::vector<std::string> mistakes_in(const std::string& motion) {
    const Folder folder;
    std::vector<std::string> mistakes;
    read_motion(folder.write("fist.chan", motion), 1, 24, mistakes);
    return mistakes;
}

/// A sound shot with a ball that has these words besides, next to its motion; what is wrong with it.
std::vector<std::string> mistakes_of_ball(const std::string& words, const std::string& motion) {
    const Folder folder;
    folder.write("fist.chan", motion);
    const std::string text = sound_shot() + "\n[[collider]]\n" + words;
    try {
        load_shot(folder.write("test.toml", text));
    } catch (const ShotFileError& error) {
        return {error.what()};
    }
    return {};
}

const std::string ball = "sphere = { center = [0, 0, 0], radius = 0.1 }\n";

}  // namespace

TEST_CASE("a motion is read frame by frame, its angles by the shorter way") {
    const Folder folder;
    std::vector<std::string> mistakes;
    const auto keys =
        read_motion(folder.write("fist.chan",
                                 "# frame tx ty tz rx ry rz\n"
                                 "1001 0 0.5 -1e-1 10 -20 170\r\n"
                                 "\n"
                                 "1002\t+1\t0.5\t0\t10\t-20\t-170\t45.2 # and a lens\n"
                                 "1004 2 0.5 0 10 -20 -90"),
                    1001,
                    25,
                    mistakes);
    CHECK(mistakes.empty());
    REQUIRE(keys.size() == 3);
    CHECK(keys[0].time == 0);
    CHECK(keys[1].time == Approx(1 / 25.0));
    CHECK(keys[2].time == Approx(3 / 25.0));
    CHECK(keys[0].translate == Vec3(0, 0.5, -0.1));
    CHECK((keys[0].rotate - degree * Vec3(10, -20, 170)).norm() < 1e-14);
    CHECK((keys[1].rotate - degree * Vec3(10, -20, 190)).norm() < 1e-14);
    CHECK((keys[2].rotate - degree * Vec3(10, -20, 270)).norm() < 1e-14);
}

TEST_CASE("mistakes in a motion are told at their lines, all at once") {
    const std::vector<std::string> mistakes = mistakes_in(
        "1 0 0 0 0 0 0\n2 0 zero 0 0 0 0\n3 0 0 0\n4 0 0 0 0 0 inf\n1 0 0 0 0 0 0\n");
    REQUIRE(mistakes.size() == 4);
    CHECK_THAT(mistakes[0], StartsWith("2:5: 'zero' is no number"));
    CHECK_THAT(mistakes[1], StartsWith("3:1: 4 numbers, must be 7: frame tx ty tz rx ry rz"));
    CHECK_THAT(mistakes[2], StartsWith("4:13: 'inf' is no number"));
    CHECK_THAT(mistakes[3], StartsWith("5:1: frames ascend: 1 is not after"));
    CHECK_THAT(mistakes_in("# nothing\n").at(0), StartsWith("1:1: no frame"));
}

TEST_CASE("a collider follows a motion about the origin, from the shot's first frame on") {
    const Folder folder;
    folder.write("fist.chan", "1 0 0 0 0 0 0\n25 1 2 3 0 0 90\n");
    const std::string text =
        sound_shot() + "\n[[collider]]\n" + ball + "follow = \"fist.chan\"\n";
    const Shot shot = load_shot(folder.write("test.toml", text));
    const sim::Collider& collider = shot.scene.colliders.at(0);
    REQUIRE(collider.keys.size() == 2);
    CHECK(collider.keys[1].time == Approx(1));
    CHECK(collider.keys[1].translate == Vec3(1, 2, 3));
    CHECK(collider.pivot == Vec3(0, 0, 0));

    // What the file holds decides the simulation.
    folder.write("fist.chan", "1 0 0 0 0 0 0\n25 1 2 3 0 0 91\n");
    CHECK(load_shot(folder.path / "test.toml").resolved != shot.resolved);
}

TEST_CASE("a motion that cannot be followed is told at its word") {
    const auto told = [](const std::string& words, const std::string& motion) {
        const std::vector<std::string> mistakes = mistakes_of_ball(words, motion);
        return mistakes.empty() ? std::string() : mistakes[0];
    };
    const std::string follow = "follow = \"fist.chan\"\n", sound = "1 0 0 0 0 0 0\n";
    CHECK(told(ball + follow, sound).empty());
    CHECK_THAT(told(ball + follow, "1 0 0\n"),
               Contains(":45:10: error: ") && Contains("fist.chan:1:1: 3 numbers"));
    CHECK_THAT(told(ball + "follow = \"foot.chan\"\n", sound),
               Contains(":45:10: error: there is no file 'foot.chan'"));
    CHECK_THAT(told(ball + "keys = [ { time = 1 } ]\n" + follow, sound),
               Contains("'keys' and 'follow' exclude each other"));
    CHECK_THAT(told("plane = { point = [0, 0, 0], normal = [0, 0, 1] }\n" + follow, sound),
               Contains("a plane stands still"));
}
