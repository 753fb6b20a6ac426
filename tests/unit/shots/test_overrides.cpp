#include <catch2/catch.hpp>

#include "shot_text.h"

using namespace shots;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

TEST_CASE("overrides replace and add words, typed as in the file") {
    const Shot shot = load_text(sound_shot(),
                                {"body.bar.region.soft.young_modulus=2e5",
                                 "body.bar.region.hard.density=2 g/cm3",
                                 "solver.method=fem",
                                 "solver.damping=0.5",
                                 "contact.friction=stick",
                                 "pin.wall.only=[\"x\"]",
                                 "force.0.gravity=[0, 0, -1]",
                                 "frames=5-7"});
    const sim::Body& bar = shot.scene.bodies.front();
    CHECK(bar.regions[1].young_modulus == 2e5);
    CHECK(bar.regions[0].density == 2000);
    CHECK(bar.regions[1].density == 2000);  // inherits the override too
    CHECK(shot.scene.solver.method == sim::Method::Fem);
    CHECK(shot.scene.solver.damping == 0.5);
    CHECK(shot.scene.contact.friction.stick);
    CHECK(shot.scene.pins.front().only == std::array{true, false, false});
    CHECK(std::get<sim::Gravity>(shot.scene.forces.front()).acceleration == Vec3(0, 0, -1));
    CHECK(shot.frames.numbers() == std::vector{5, 6, 7});
}

TEST_CASE("wrong overrides point at the option") {
    struct Case {
        const char* assignment;
        const char* message;
    };

    const auto row = GENERATE(values<Case>({
        {"solver.mehtod=fem", "did you mean 'method'?"},
        {"sovler.method=fem", "did you mean 'solver'?"},
        {"solver.dt=3 mm", "'3 mm' is a length, not a time"},
        {"solver.dt=-1", "greater than 0"},
        {"pin.wal.until=1", "there is no 'wal'; did you mean 'wall'?"},
        {"force.1.gravity=[0, 0, 0]", "there is no '1'"},
        {"fps.x=1", "holds no words"},
        {"fps", "write --set key.path=value"},
        {"body.bar.region.soft.select={ sphere = { center = [0, 0, 0], radius = -1 } }",
         "greater than 0"},
    }));
    INFO(row.assignment);
    const auto lines = mistakes_of(sound_shot(), {row.assignment});
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines.front(),
               StartsWith(std::string("--set ") + row.assignment + ": error: ")
                   && Contains(row.message));
}

TEST_CASE("keys of later errors are found again") {
    const Shot shot = load_text(sound_shot(), {"pin.wall.until=2"});
    const auto line_of = [&](const char* key) {
        const std::string place = shot.sources.place(key);
        return place.substr(place.find(".toml") + 5);
    };
    CHECK(line_of("body.bar.region.soft.select") == ":24:10");
    CHECK(line_of("body.bar.region.soft.select.box.max") == ":24:47");
    CHECK(line_of("body.bar.region.soft") == ":22:1");
    CHECK(line_of("body.bar.region.soft.density") == ":22:1");  // left out: its table
    CHECK(line_of("force.0.gravity") == ":33:11");
    CHECK(line_of("nowhere") == "");
    CHECK(shot.sources.place("pin.wall.until") == "--set pin.wall.until=2");
    CHECK(shot.scene.bodies[0].regions[1].select.key == "body.bar.region.soft.select");
    CHECK(shot.scene.pins[0].select.key == "pin.wall.select");
}

TEST_CASE("the fingerprint knows what decides the simulation, and nothing else") {
    const assets::Fingerprint base = load_text(sound_shot()).resolved;
    const auto same = [&](const char* assignment) {
        return load_text(sound_shot(), {assignment}).resolved == base;
    };
    CHECK(same("output.samples=7"));
    CHECK(same("camera.lens=80"));
    CHECK(same("frames=1-96"));
    CHECK(same("solver.method=enriched"));
    CHECK(same("solver.grid_ratio=2"));  // the default
    CHECK(same("body.bar.domain_size=0.025"));

    CHECK_FALSE(same("frames=2-48"));
    CHECK_FALSE(same("fps=25"));
    CHECK_FALSE(same("solver.dt=2 ms"));
    CHECK_FALSE(same("solver.damping=0.1"));
    CHECK_FALSE(same("body.bar.region.soft.select.box.max=[0.7, 1, 1]"));
    CHECK_FALSE(same("body.bar.region.soft.color=[0, 0, 1]"));
    CHECK_FALSE(same("pin.wall.until=1"));
    CHECK_FALSE(same("force.0.gravity=[0, 0, -9.8]"));
    CHECK_FALSE(same("contact.friction=0.1"));
    CHECK_FALSE(same("probe.tip.point=[0, 0, 0]"));
}
