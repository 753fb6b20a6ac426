#include "assets/base/edit_distance.h"
#include "assets/base/error.h"
#include "shots/text/frame_range.h"
#include "shots/text/suggestion.h"
#include "shots/text/units.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace shots;

TEST_CASE("quantities carry their units") {
    struct Case {
        const char* text;
        Dimension dimension;
        double value;
    };

    const auto row = GENERATE(values<Case>({
        {"200 kPa", Dimension::Pressure, 200e3},
        {"200kPa", Dimension::Pressure, 200e3},
        {"1.5e-1 MPa", Dimension::Pressure, 150e3},
        {"25 mm", Dimension::Length, 0.025},
        {"7 mm", Dimension::Length, 0.007},
        {"-3 cm", Dimension::Length, -0.03},
        {"+2", Dimension::Length, 2},
        {"1 ms", Dimension::Time, 0.001},
        {"9.81 m/s2", Dimension::Acceleration, 9.81},
        {"9.81 m/s^2", Dimension::Acceleration, 9.81},
        {"1 g/cm3", Dimension::Density, 1000},
        {"36 km/h", Dimension::Velocity, 10},
        {"8 N", Dimension::Force, 8},
        {"45 %", Dimension::Number, 0.45},
        {"3.5 cm", Dimension::FocalLength, 35},
        {"50", Dimension::FocalLength, 50},
    }));
    INFO(row.text);
    // Exact: "25 mm" and 0.025 must be one fingerprint.
    CHECK(parse_quantity(row.text, row.dimension) == row.value);
}

TEST_CASE("angles become radians") {
    constexpr double pi = std::numbers::pi;
    CHECK(parse_quantity("30 deg", Dimension::Angle) == Approx(pi / 6).epsilon(1e-15));
    CHECK(parse_quantity("90 deg/s", Dimension::AngularVelocity)
          == Approx(pi / 2).epsilon(1e-15));
    CHECK(parse_quantity("60 rpm", Dimension::AngularVelocity)
          == Approx(2 * pi).epsilon(1e-15));
}

TEST_CASE("wrong units are told what is allowed") {
    using Catch::Matchers::Contains;
    CHECK_THROWS_WITH(
        parse_quantity("25 mm", Dimension::Pressure),
        Contains("'25 mm' is a length, not a pressure") && Contains("Pa, kPa, MPa, GPa"));
    CHECK_THROWS_WITH(parse_quantity("25 kpa", Dimension::Pressure),
                      Contains("unknown unit 'kpa'") && Contains("did you mean 'kPa'"));
    for (const char* text : {"", "kPa", "1,5 kPa", "inf", "nan kPa", "1e999", "1 kPa kPa"})
        CHECK_THROWS_AS(parse_quantity(text, Dimension::Pressure), assets::Error);
}

TEST_CASE("the edit distance counts insertions, deletions, replacements and swaps") {
    CHECK(assets::edit_distance("", "abc") == 3);
    CHECK(assets::edit_distance("kitten", "sitting") == 3);
    CHECK(assets::edit_distance("solver", "sovler") == 1);
    CHECK(assets::edit_distance("same", "same") == 0);
}

TEST_CASE("suggestions are near or absent") {
    const std::vector<std::string> words{
        "young_modulus", "poisson_ratio", "density", "box", "x"};
    CHECK(nearest("youngs_modulus", words) == "young_modulus");
    CHECK(nearest("poisson", words) == "poisson_ratio");
    CHECK(nearest("DENSITY", words) == "density");
    CHECK(nearest("bx", words) == "box");
    CHECK(nearest("w", words).empty());
    CHECK(nearest("colour", words).empty());
}

TEST_CASE("frame ranges") {
    CHECK(parse_frame_range("1-4").numbers() == std::vector{1, 2, 3, 4});
    CHECK(parse_frame_range("1001-1006x2").numbers() == std::vector{1001, 1003, 1005});
    CHECK(parse_frame_range("7").numbers() == std::vector{7});
    CHECK(parse_frame_range("-2-1").numbers() == std::vector{-2, -1, 0, 1});
    CHECK(parse_frame_range("-5--4").numbers() == std::vector{-5, -4});
    CHECK(parse_frame_list("5, 1-3 2,9-11x2") == std::vector{1, 2, 3, 5, 9, 11});
    for (const char* text :
         {"", "a", "1-", "3-1", "1-4x0", "1-4x", "1-4y", "1 - 4", "99999999999", "-2147483648"})
        CHECK_THROWS_AS(parse_frame_range(text), assets::Error);
    CHECK_THROWS_AS(parse_frame_list(" , "), assets::Error);
    CHECK_THROWS_WITH(parse_frame_list("1-99999999999"),
                      Catch::Matchers::Contains("from -10000000 to 10000000"));
}
