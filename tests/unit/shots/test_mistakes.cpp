// Every kind of mistake is told at its place, alone, with what would be right.
#include <catch2/catch.hpp>

#include "shot_text.h"

using namespace shots;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

struct Case {
    const char* old_piece;
    const char* new_piece;
    const char* place;    // "line:column: "
    const char* message;  // a part of it
};

void check_single_mistake(const Case& row) {
    INFO(row.old_piece << " -> " << row.new_piece);
    const auto lines = mistakes_of(with(sound_shot(), row.old_piece, row.new_piece));
    INFO(Catch::StringMaker<std::vector<std::string>>::convert(lines));
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines.front(),
               StartsWith(row.place) && Contains("error: ") && Contains(row.message));
}

}  // namespace

TEST_CASE("the sound shot is sound") {
    CHECK(mistakes_of(sound_shot()).empty());
}

TEST_CASE("missing words are told at their table") {
    check_single_mistake(GENERATE(values<Case>({
        {"format = 1\n", "\n", "1:1: ", "missing 'format'"},
        {"frames = \"1-48\"\n", "\n", "1:1: ", "missing 'frames'"},
        {"domain_size = \"25 mm\"\n",
         "\n",
         "11:1: ",
         "missing 'domain_size' (a length) in body.bar"},
        {"young_modulus = \"1 MPa\"\n",
         "\n",
         "15:1: ",
         "missing 'young_modulus' (a pressure) in body.bar.region.hard"},
        {"density = 1000\n", "\n", "15:1: ", "missing 'density'"},
        {"select = \"all\"\n", "\n", "15:1: ", "missing 'select'"},
        {"shape = { box = { min = [0, 0, 0], max = [1, 0.1, 0.1] } }\n",
         "\n",
         "11:1: ",
         "missing one of shape, mesh"},
        {"gravity = [0, 0, \"-9.81 m/s2\"]\n", "\n", "32:1: ", "missing one of gravity, total"},
        {"point = [1, 0.05, 0.05]\n", "\n", "35:1: ", "missing one of point, region"},
        {"name = \"wall\"\n", "\n", "27:1: ", "missing 'name'"},
    })));
}

TEST_CASE("a matt look has no roughness") {
    check_single_mistake({"[[pin]]\n",
                          "[[body.bar.skin]]\nname = \"a\"\nsource = \"self\"\n"
                          "look = { coated = false, roughness = 0.3 }\n[[pin]]\n",
                          "30:38: ",
                          "leave it out where 'coated' = false"});
}

TEST_CASE("unknown words get the nearest valid one") {
    check_single_mistake(GENERATE(values<Case>({
        {"[solver]", "[sovler]", "7:2: ", "unknown word 'sovler'; did you mean 'solver'?"},
        {"method = ", "mehtod = ", "8:1: ", "did you mean 'method'?"},
        {"young_modulus = \"1 MPa\"",
         "youngs_modulus = \"1 MPa\"",
         "18:1: ",
         "did you mean 'young_modulus'?"},
        {"poisson_ratio", "poisson", "19:1: ", "did you mean 'poisson_ratio'?"},
        {"select = { half_space",
         "select = { halfspace",
         "30:12: ",
         "did you mean 'half_space'?"},
        {"normal = ", "nromal = ", "30:46: ", "did you mean 'normal'?"},
        {"\"enriched\"", "\"enrich\"", "8:10: ", "did you mean 'enriched'?"},
        {"[output]", "[outputs]", "40:2: ", "did you mean 'output'?"},
        {"density = 1000", "density = 1000\ndensty = 2", "21:1: ", "did you mean 'density'?"},
        {"point = [1, 0.05, 0.05]",
         "region = \"sofd\"",
         "38:10: ",
         "no region 'sofd'; did you mean 'soft'?"},
        {"name = \"wall\"\nbody = \"bar\"",
         "name = \"wall\"\nbody = \"bra\"",
         "29:8: ",
         "no body 'bra'; did you mean 'bar'?"},
    })));
}

TEST_CASE("wrong values are told with what is allowed") {
    check_single_mistake(GENERATE(values<Case>({
        {"\"1 MPa\"", "\"25 mm\"", "18:17: ", "'25 mm' is a length, not a pressure"},
        {"\"1 MPa\"", "\"1 mpa\"", "18:17: ", "did you mean 'MPa'?"},
        {"\"1 MPa\"", "-1e6", "18:17: ", "greater than 0"},
        {"\"1 MPa\"", "0", "18:17: ", "greater than 0"},
        {"\"1 MPa\"", "1e31", "18:17: ", "from -1e+30 to 1e+30"},
        {"\"1 MPa\"", "nan", "18:17: ", "must be"},
        {"\"1 MPa\"", "true", "18:17: ", "must be a pressure; found true"},
        {"\"1 MPa\"", "2001-01-01", "18:17: ", "dates"},
        {"poisson_ratio = 0.3", "poisson_ratio = 0.5", "19:17: ", "less than 0.5"},
        {"poisson_ratio = 0.3", "poisson_ratio = -1", "19:17: ", "greater than -1"},
        {"density = 1000", "density = -1", "20:11: ", "greater than 0"},
        {"density = 1000", "density = 1000\ncolor = [0.5, 1.5, 0]", "21:15: ", "at most 1"},
        {"domain_size = \"25 mm\"", "domain_size = \"-25 mm\"", "13:15: ", "greater than 0"},
        {"domain_size = \"25 mm\"", "domain_size = \"1 um\"", "13:15: ", "domains"},
        {"max = [1, 0.1, 0.1]", "max = [1, 0.1]", "12:42: ", "an array of three"},
        {"max = [1, 0.1, 0.1]",
         "max = [1, 0, 0.1]",
         "12:42: ",
         "'max' must be greater than 'min'"},
        {"max = [1, 0.1, 0.1]",
         "max = [1, 0.1, \"3 s\"]",
         "12:51: ",
         "'3 s' is a time, not a length"},
        {"max = [1, 0.1, 0.1]", "max = [2e3, 0.1, 0.1]", "12:9: ", "outside the world"},
        {"frames = \"1-48\"", "frames = \"48-1\"", "3:10: ", "before it starts"},
        {"fps    = 24", "fps    = 0", "4:10: ", "greater than 0"},
        {"\"1 ms\"", "0", "9:10: ", "greater than 0"},
        {"normal = [1, 0, 0]", "normal = [0, 0, 0]", "30:55: ", "must have a length"},
        {"size = [64, 36]", "size = [64]", "41:8: ", "[width, height]"},
        {"size = [64, 36]", "samples = 0", "41:11: ", "whole number"},
        {"size = [64, 36]", "path = \"out/{name}\"", "41:8: ", "{shot}"},
        {"select = \"all\"", "select = { depth = 1 }", "17:10: ", "must be \"all\""},
        {"select = \"all\"", "select = \"everything\"", "17:10: ", "no shape 'everything'"},
        {"name = \"soft\"", "name = \"hard\"", "23:8: ", "stands twice"},
        {"name = \"soft\"", "name = \"a.b\"", "23:8: ", "letters, digits"},
        {"shape = { box = { min = [0, 0, 0], max = [1, 0.1, 0.1] } }",
         "mesh = \"frog.glb\"",
         "12:8: ",
         "no file 'frog.glb'"},
        {"[[force]]\ngravity", "[force]\ngravity", "32:1: ", "write [[force]]"},
        {"units  = { up = \"z\" }", "units  = ", "5:10: ", "expected value"},
        {"[output]",
         "[[collider]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\nkeys = [{ time = 1 }, { "
         "time = 1 }]\n[output]",
         "42:32: ",
         "the times of keys ascend"},
        {"[output]",
         "[[collider]]\nplane = { point = [0, 0, 0], normal = [0, 0, 1] }\nkeys = [{ time = 1 "
         "}]\n[output]",
         "42:8: ",
         "a plane stands still"},
    })));
}

TEST_CASE("mistakes in shapes are told where they stand") {
    const auto with_shapes = [](const std::string& shapes) {
        return mistakes_of(with(sound_shot(), "[output]", "[shapes]\n" + shapes + "[output]"));
    };
    const std::string ball = "ball = { sphere = { center = [0, 0, 0], radius = 1 } }\n";
    CHECK(with_shapes(ball
                      + "pair = { mirror = \"ball\", point = [2, 0, 0], normal = [1, 0, 0] }\n")
              .empty());

    struct ShapeCase {
        const char* line;  // line 42
        const char* place;
        const char* message;
    };

    for (const ShapeCase& row : std::initializer_list<ShapeCase>{
             {"two = { union = [\"ball\", \"bal\"] }",
              "42:26: ",
              "there is no shape 'bal'; did you mean 'ball'? ([shapes] has: ball)"},
             {"two = { union = [\"two\"] }", "42:18: ", "there is no shape 'two'"},
             {"two = { untion = [\"ball\"] }", "42:9: ", "did you mean 'union'?"},
             {"two = { union = \"ball\" }", "42:17: ", "must be an array of shapes"},
             {"two = { union = [] }", "42:17: ", "must be an array of shapes"},
             {"two = { union = [3] }", "42:18: ", "must be a table; found 3"},
             {"two = { union = [\"ball\"], smoth = 1 }", "42:27: ", "did you mean 'smooth'?"},
             {"two = { union = [\"ball\"], smooth = -1 }", "42:36: ", "at least 0"},
             {"two = { moved = \"ball\", rotate = [0, 0, \"1 m\"] }",
              "42:41: ",
              "not an angle"},
             {"two = { ring = \"ball\", point = [0, 0, 0], axis = [0, 0, 1] }",
              "42:7: ",
              "missing 'count'"},
             {"two = { ring = \"ball\", point = [0, 0, 0], axis = [0, 0, 0], count = 2 }",
              "42:50: ",
              "must have a length"},
             {"two = { ellipsoid = { center = [0, 0, 0], radii = [1, 0, 1] } }",
              "42:51: ",
              "greater than 0"},
             {"all = { box = { min = [0, 0, 0], max = [1, 1, 1] } }",
              "42:7: ",
              "'all' has a meaning of its own"},
         }) {
        INFO(row.line);
        const auto lines = with_shapes(ball + row.line + "\n");
        INFO(Catch::StringMaker<std::vector<std::string>>::convert(lines));
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines.front(), StartsWith(row.place) && Contains(row.message));
    }
}

TEST_CASE("words of features to come are told apart from mistakes") {
    check_single_mistake(GENERATE(values<Case>({
        {"\"enriched\"", "\"auto\"", "8:10: ", "not available yet"},
        {"dt     = \"1 ms\"", "elements = \"tet\"", "9:12: ", "not available yet"},
        {"dt     = \"1 ms\"", "tolerance = \"1%\"", "9:13: ", "not available yet"},
        {"size = [64, 36]", "images = [\"exr\"]", "41:11: ", "not available yet"},
        {"size = [64, 36]", "renderer = \"raster\"", "41:12: ", "not available yet"},
    })));
}

TEST_CASE("points cannot do everything") {
    check_single_mistake(GENERATE(values<Case>({
        {"\"enriched\"", "\"mpm\"\nsteps = \"bdf2\"", "9:9: ", "bdf2"},
        {"\"enriched\"",
         "\"mpm\"\nsteps = \"explicit\"\nkernel = \"linear\"",
         "10:10: ",
         "next to no mass"},
        {"density = 1000",
         "density = 1000\nmodel = \"snow\"\nstretch_limit = 0",
         "22:17: ",
         "greater than 0"},
        {"density = 1000",
         "density = 1000\nmodel = \"snow\"\ncompression_limit = 1",
         "22:21: ",
         "less than 1"},
        {"density = 1000", "density = 1000\nhardening = 10", "21:1: ", "unknown word"},
        {"dt     = \"1 ms\"", "transfer = \"pic\"", "9:12: ", "flip"},
        {"dt     = \"1 ms\"", "pic_rate = -1", "9:12: ", "at least 0"},
    })));
    const std::string own = "domain_size = \"25 mm\"";
    const auto with_method = [&](const std::string& words) {
        return mistakes_of(with(with(sound_shot(), own, own + "\n" + words),
                                "dt     = \"1 ms\"",
                                "steps  = \"bdf2\""));
    };
    REQUIRE(with_method("method = \"mpm\"").size() == 1);
    CHECK_THAT(with_method("method = \"mpm\"").front(),
               StartsWith("14:10: ") && Contains("bdf2"));
    CHECK(with_method("method = \"domains\"").empty());
    const auto snow = mistakes_of(with(with(sound_shot(), own, own + "\nmethod = \"domains\""),
                                       "density = 1000",
                                       "density = 1000\nmodel = \"snow\""));
    REQUIRE(snow.size() >= 1);
    CHECK_THAT(snow.front(), StartsWith("14:10: ") && Contains("only points"));
}

TEST_CASE("static steps need the method fem") {
    const std::string text = with(sound_shot(), "dt     = \"1 ms\"", "steps  = \"static\"");
    const auto lines = mistakes_of(text);
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines.front(), StartsWith("9:10: ") && Contains("fem"));
    const std::string of_fem = with(text, "\"enriched\"", "\"fem\"");
    CHECK(mistakes_of(of_fem).empty());
    const auto on_grid = mistakes_of(of_fem + "\n[contact]\nmode = \"grid\"\n");
    REQUIRE(on_grid.size() == 1);
    CHECK_THAT(on_grid.front(), Contains("'mode' = 'grid' meets velocities"));
}

TEST_CASE("all mistakes come in one pass, in the order of the file") {
    std::string text = with(sound_shot(), "\"1 MPa\"", "-1");
    text = with(text, "[solver]", "[sovler]");
    text = with(text, "fps    = 24", "fps    = \"x\"");
    const auto lines = mistakes_of(text, {"solver.dt=0"});
    REQUIRE(lines.size() == 4);
    CHECK_THAT(lines[0], StartsWith("4:10: error: "));
    CHECK_THAT(lines[1], StartsWith("7:2: error: "));
    CHECK_THAT(lines[2], StartsWith("18:17: error: "));
    CHECK_THAT(lines[3], StartsWith("--set solver.dt=0: error: "));
}

TEST_CASE("odd values are warnings") {
    std::string text = with(sound_shot(), "poisson_ratio = 0.3", "poisson_ratio = 0.46");
    const Shot shot = load_text(with(text, "\"100 kPa\"", "20"));
    REQUIRE(shot.warnings.size() == 2);
    CHECK_THAT(shot.warnings[0], Contains(":19:17: warning: "));
    CHECK_THAT(shot.warnings[1], Contains(":25:17: warning: ") && Contains("kPa meant?"));
}

TEST_CASE("an empty file tells what is missing") {
    CHECK(mistakes_of("").size() == 4);  // format, shot, frames, a body
}
