// What stands in a shot file arrives in the scene.
#include <catch2/catch.hpp>

#include "shot_text.h"
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>

using namespace shots;

namespace {

std::string vocabulary() {
    std::ifstream stream(SOURCE_ROOT "/tests/unit/shots/data/vocabulary.toml");
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("the whole vocabulary is read") {
    const Shot shot = load_text(vocabulary());
    CHECK(shot.name == "example");
    CHECK(shot.frames.last == 48);
    CHECK(shot.render.up == Vec3::UnitZ());
    CHECK(shot.output == "out/example");
    CHECK(shot.time_of(25) == 1.0);
    CHECK(shot.warnings.empty());

    const sim::Scene& scene = shot.scene;
    CHECK(scene.solver.method == sim::Method::Enriched);
    CHECK(scene.solver.steps == sim::Steps::Implicit);
    CHECK(scene.solver.dt == 0.001);
    REQUIRE(scene.bodies.size() == 1);
    const sim::Body& bar = scene.bodies.front();
    CHECK(std::get<assets::Box>(std::get<assets::Shape>(bar.source.geometry)).max
          == Vec3(0.45, 0.075, 0.075));
    REQUIRE(bar.regions.size() == 2);
    CHECK(bar.regions[1].young_modulus == 100e3);
    CHECK(bar.regions[1].poisson_ratio == 0.3);  // inherited
    CHECK(std::get<assets::Box>(std::get<assets::Shape>(bar.regions[1].select.is)).min.x()
          == 0.15);
    REQUIRE(bar.skins.size() == 1);
    CHECK_FALSE(bar.skins.front().source);
    CHECK(shot.render.looks.at({"bar", "outside"}).color_by == render::ColorBy::Look);

    CHECK(std::holds_alternative<sim::Selector::HalfSpace>(scene.pins.at(0).select.is));
    CHECK(std::get<sim::Gravity>(scene.forces.at(0)).acceleration == Vec3(0, 0, -10));
    CHECK(std::get<sim::DeadLoad>(scene.forces.at(1)).body == "bar");
    CHECK(scene.colliders.at(0).friction.coefficient == 0.4);
    CHECK(shot.render.props.at(0).point == Vec3(0, 0, -0.6));
    CHECK(scene.contact.mode == sim::Contact::Mode::Grid);
    CHECK(scene.contact.friction.coefficient == 0.3);
    CHECK(scene.contact.pairs.at(0).bodies == std::array<std::string, 2>{"bar", "bar"});
    CHECK(scene.contact.pairs.at(0).friction.coefficient == 0);
    CHECK(std::get<std::string>(scene.probes.at(1).at) == "soft");
    CHECK(shot.render.samples == 64);
}

TEST_CASE("the alternatives of the vocabulary are read") {
    constexpr double pi = std::numbers::pi;
    std::string text =
        with(sound_shot(),
             "shape = { box = { min = [0, 0, 0], max = [1, 0.1, 0.1] } }",
             "shape = { torus = { center = [0, 0, 0], axis = [0, 0, 2], major = 0.5, minor = "
             "\"10 cm\" } }\n"
             "transform = { scale = 2.0, rotate = [0, 0, \"30 deg\"], translate = [0, 0, 1] }\n"
             "velocity = [1, 0, 0]\nspin = [0, 0, \"90 deg/s\"]");
    text =
        with(text,
             "select = { box = { min = [0.4, -1, -1], max = [0.6, 1, 1] } }",
             "select = { all_of = [{ not = { sphere = { center = [0, 0, 0], radius = 1 } } }, "
             "{ any_of = [\"all\", { depth = 0.002 }, { mesh_material = \"Muscle*\" }] }] }");
    text = with(text,
                "normal = [1, 0, 0] } }",
                "normal = [1, 0, 0] } }\nspin = { axis = [0, 0, 1], point = [0, 0, 0], rate = "
                "\"90 deg/s\" }\n"
                "until = \"500 ms\"\nonly = [\"z\"]");
    text = with(
        text,
        "[output]",
        "[[collider]]\nsphere = { center = [0, 0, -1], radius = 0.5 }\nfriction = \"stick\"\n"
        "[[body.bar.skin]]\nname = \"core\"\nsource = { sphere = { center = [0, 0, 0], radius "
        "= 1 } }\n"
        "look = { color_by = \"stretch\", opacity = 0.5, coated = false }\n"
        "[camera]\nposition = [1, 2, 3]\nlook_at = [0, 0, 0]\nlens = \"3.5 cm\"\n[output]");
    text = with(text, "dt     = \"1 ms\"", "quadrature = \"eight_point\"");
    const Shot shot = load_text(text);
    CHECK(shot.scene.solver.quadrature == sim::Quadrature::EightPoint);
    const sim::Body& body = shot.scene.bodies.front();
    CHECK(std::get<assets::Torus>(std::get<assets::Shape>(body.source.geometry)).minor == 0.1);
    CHECK(body.source.transform.rotate.z() == Approx(pi / 6));
    CHECK(body.spin.z() == Approx(pi / 2));
    const auto& all_of = std::get<sim::Selector::AllOf>(body.regions[1].select.is).of;
    REQUIRE(all_of.size() == 2);
    CHECK(std::get<sim::Selector::Not>(all_of[0].is).of.size() == 1);
    CHECK(std::get<sim::Selector::AnyOf>(all_of[1].is).of.size() == 3);
    CHECK(all_of[1].key == "body.bar.region.soft.select.all_of.1");
    const sim::Pin& pin = shot.scene.pins.front();
    CHECK(std::get<sim::Pin::Spin>(pin.moves).rate == Approx(pi / 2));
    CHECK(pin.until == 0.5);
    CHECK(pin.only == std::array{false, false, true});
    CHECK(shot.scene.colliders.front().friction.stick);
    CHECK(body.skins.front().source.has_value());
    CHECK(shot.render.looks.at({"bar", "core"}).color_by == render::ColorBy::Stretch);
    CHECK_FALSE(shot.render.looks.at({"bar", "core"}).coated);
    CHECK_FALSE(shot.render.camera.frame_bodies);
    CHECK(shot.render.camera.lens == 35);
}

TEST_CASE("shapes have names, and combine") {
    constexpr double pi = std::numbers::pi;
    using assets::signed_distance;
    std::string text = with(vocabulary(),
                            "shape = { box = { min = [0, -0.075, -0.075], max = [0.45, 0.075, "
                            "0.075] } }",
                            "shape = \"blossom\"");
    text = with(text, "source = \"self\"", "source = \"cup\"");
    text = with(text,
                "select = { box = { min = [0.15, -1, -1], max = [0.30, 1, 1] } }",
                "select = { all_of = [\"crown\", { not = { moved = \"ears\" } }] }");
    text = with(text,
                "[contact]",
                "[[collider]]\nintersection = [\"both\"]\n"
                "[[collider]]\nmirror = \"tilted\"\npoint = [1, 0, 0]\nnormal = [2, 0, 0]\n"
                "[contact]");
    const sim::Scene scene = load_text(text).scene;
    const sim::Body& body = scene.bodies.front();
    const auto& blossom = std::get<assets::Shape>(body.source.geometry);
    CHECK(std::get<assets::Combination>(blossom).smooth == 0.01);
    CHECK(std::get<assets::Combination>(blossom).of.size() == 2);
    // Where a petal of the ring ends, and a sixth of a turn on: the way of its 8 cm beyond 10 cm, tilted by 15 degrees.
    const double reach = 0.18 * std::cos(pi / 12), height = 0.01 + 0.18 * std::sin(pi / 12);
    for (const double angle : {0.0, pi / 3})
        CHECK(std::abs(signed_distance(
                  blossom, {reach * std::cos(angle), reach * std::sin(angle), height}))
              < 1e-9);
    CHECK(signed_distance(std::get<assets::Shape>(body.skins.front().source->geometry),
                          {0.1, 0, 0})
          > 0);  // the ears are cut out
    const auto& all_of = std::get<sim::Selector::AllOf>(body.regions[1].select.is).of;
    CHECK(signed_distance(std::get<assets::Shape>(all_of.at(0).is), {0.1, 0, 0.035}) < 0);
    CHECK(std::holds_alternative<sim::Selector::Not>(all_of.at(1).is));
    using Kind = assets::Combination::Kind;
    const auto& both = std::get<assets::Shape>(scene.colliders.at(1).shape);
    CHECK(std::get<assets::Combination>(both).kind == Kind::Intersection);
    const auto& mirrored = std::get<assets::Shape>(scene.colliders.at(2).shape);
    CHECK(signed_distance(mirrored, {2 - reach, 0, height}) == Approx(0).margin(1e-9));
}

TEST_CASE("bodies have methods and kernels of their own") {
    using sim::Kernel;
    using sim::Method;
    const auto solver_and_body = [](const std::string& of_solver,
                                    const std::string& of_body,
                                    const std::string& of_region) {
        std::string text = with(sound_shot(), "method = \"enriched\"", of_solver);
        text = with(text, "domain_size = \"25 mm\"", "domain_size = \"25 mm\"\n" + of_body);
        text = with(text, "density = 1000", "density = 1000\n" + of_region);
        const sim::Scene scene = load_text(text).scene;
        return std::pair(method_of(scene.solver, scene.bodies[0]),
                         kernel_of(scene.solver, scene.bodies[0]));
    };
    CHECK(solver_and_body("", "", "") == std::pair(Method::Enriched, Kernel::Linear));
    CHECK(solver_and_body("method = \"mpm\"", "", "")
          == std::pair(Method::Mpm, Kernel::Quadratic));
    CHECK(solver_and_body("kernel = \"cubic\"", "", "")
          == std::pair(Method::Enriched, Kernel::Cubic));
    CHECK(solver_and_body("method = \"mpm\"", "method = \"domains\"", "")
          == std::pair(Method::Domains, Kernel::Linear));
    CHECK(solver_and_body("method = \"fem\"", "method = \"mpm\"\nkernel = \"linear\"", "")
          == std::pair(Method::Mpm, Kernel::Linear));
    CHECK(solver_and_body("", "", "model = \"snow\"")
          == std::pair(Method::Mpm, Kernel::Quadratic));

    const sim::Scene snow =
        load_text(with(with(sound_shot(),
                            "density = 1000",
                            "density = 1000\nmodel = \"snow\"\nhardening = 15\n"
                            "compression_limit = 0.02\nstretch_limit = \"0.5%\""),
                       "dt     = \"1 ms\"",
                       "transfer = \"apic\"\npic_rate = 2"))
            .scene;
    CHECK(snow.solver.transfer == sim::Transfer::Apic);
    CHECK(snow.solver.pic_rate == 2);
    for (const sim::Region& region : snow.bodies[0].regions) {  // later layers inherit
        CHECK(region.model == sim::Model::Snow);
        CHECK(region.snow.hardening == 15);
        CHECK(region.snow.compression_limit == 0.02);
        CHECK(region.snow.stretch_limit == 0.005);
    }
}

TEST_CASE("the shots that ship are sound") {
    int n = 0;
    for (const auto& entry : std::filesystem::directory_iterator(SOURCE_ROOT "/shots"))
        if (entry.path().extension() == ".toml") {
            CAPTURE(entry.path());
            const Shot shot = load_shot(entry.path());
            CHECK(shot.warnings.empty());
            CHECK(shot.name == entry.path().stem());
            ++n;
        }
    CHECK(n >= 11);  // an experiment each
}

TEST_CASE("how a solver steps, enriches and meets is read word by word") {
    const auto scene_with = [](const std::string& solver, const std::string& rest = "") {
        return load_text(with(sound_shot(), "dt     = \"1 ms\"", solver) + rest).scene;
    };
    using sim::Steps;
    const std::map<std::string, Steps> steps = {{"explicit", Steps::Explicit},
                                                {"semi_implicit", Steps::SemiImplicit},
                                                {"implicit", Steps::Implicit},
                                                {"bdf2", Steps::Bdf2}};
    for (const auto& [word, value] : steps)
        CHECK(scene_with("steps = \"" + word + "\"").solver.steps == value);

    const auto enriched_by = [&](const std::string& words) {
        const auto [interface, thin, mixed_cell, strain] =
            scene_with("enrich = [" + words + "]").solver.enrich;
        return std::array{interface, thin, mixed_cell, strain};
    };
    CHECK(enriched_by("\"interface\"") == std::array{true, false, false, false});
    CHECK(enriched_by("\"thin\"") == std::array{false, true, false, false});
    CHECK(enriched_by("\"mixed_cell\", \"strain\"") == std::array{false, false, true, true});
    const sim::Scene usual = scene_with("grid_ratio = 4");
    CHECK(usual.solver.grid_ratio == 4);
    CHECK((usual.solver.enrich.interface && usual.solver.enrich.thin));
    CHECK(usual.contact.mode == sim::Contact::Mode::Surface);
    CHECK(scene_with("grid_ratio = 2", "\n[contact]\nmode = \"grid\"\n").contact.mode
          == sim::Contact::Mode::Grid);
}

TEST_CASE("bodies keep the order of the file") {
    const Shot shot = load_text(
        with(sound_shot(),
             "[[pin]]",
             "[body.a]\nshape = { sphere = { center = [0, 0, 3], radius = 1 } }\n"
             "domain_size = 0.1\n[[body.a.region]]\nname = \"all\"\nselect = \"all\"\n"
             "young_modulus = 1e5\npoisson_ratio = 0.3\ndensity = 1000\n[[pin]]"));
    REQUIRE(shot.scene.bodies.size() == 2);
    CHECK(shot.scene.bodies[0].name == "bar");
    CHECK(shot.scene.bodies[1].name == "a");
    CHECK(shot.scene.bodies[1].skins.front().name == "self");
}
