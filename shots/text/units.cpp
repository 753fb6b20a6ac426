#include "shots/text/units.h"

#include "assets/base/error.h"
#include "shots/text/suggestion.h"

#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <vector>

namespace shots {
namespace {

struct Unit {
    Dimension dimension;
    std::string_view name;
    double times,
        per = 1;  // value in SI (focal lengths: mm) = number * times / per; both exact, so that
                  // "25 mm" is the same number as 0.025
};

constexpr double half_turn = std::numbers::pi;
constexpr double turn = 2 * std::numbers::pi;

constexpr std::array units{
    Unit{Dimension::Number, "%", 1, 100},
    Unit{Dimension::Length, "m", 1},
    Unit{Dimension::Length, "cm", 1, 100},
    Unit{Dimension::Length, "mm", 1, 1e3},
    Unit{Dimension::Length, "um", 1, 1e6},
    Unit{Dimension::Length, "km", 1e3},
    Unit{Dimension::Angle, "rad", 1},
    Unit{Dimension::Angle, "deg", half_turn, 180},
    Unit{Dimension::Angle, "turn", turn},
    Unit{Dimension::Time, "s", 1},
    Unit{Dimension::Time, "ms", 1, 1e3},
    Unit{Dimension::Time, "us", 1, 1e6},
    Unit{Dimension::Time, "min", 60},
    Unit{Dimension::Rate, "1/s", 1},
    Unit{Dimension::Rate, "Hz", 1},
    Unit{Dimension::Velocity, "m/s", 1},
    Unit{Dimension::Velocity, "cm/s", 1, 100},
    Unit{Dimension::Velocity, "mm/s", 1, 1e3},
    Unit{Dimension::Velocity, "km/h", 10, 36},
    Unit{Dimension::AngularVelocity, "rad/s", 1},
    Unit{Dimension::AngularVelocity, "deg/s", half_turn, 180},
    Unit{Dimension::AngularVelocity, "turn/s", turn},
    Unit{Dimension::AngularVelocity, "rpm", turn, 60},
    Unit{Dimension::Acceleration, "m/s2", 1},
    Unit{Dimension::Acceleration, "cm/s2", 1, 100},
    Unit{Dimension::Acceleration, "mm/s2", 1, 1e3},
    Unit{Dimension::Pressure, "Pa", 1},
    Unit{Dimension::Pressure, "kPa", 1e3},
    Unit{Dimension::Pressure, "MPa", 1e6},
    Unit{Dimension::Pressure, "GPa", 1e9},
    Unit{Dimension::Pressure, "N/m2", 1},
    Unit{Dimension::Pressure, "N/mm2", 1e6},
    Unit{Dimension::Density, "kg/m3", 1},
    Unit{Dimension::Density, "g/cm3", 1e3},
    Unit{Dimension::Density, "kg/l", 1e3},
    Unit{Dimension::Force, "N", 1},
    Unit{Dimension::Force, "mN", 1, 1e3},
    Unit{Dimension::Force, "kN", 1e3},
    Unit{Dimension::Force, "MN", 1e6},
    Unit{Dimension::FocalLength, "mm", 1},
    Unit{Dimension::FocalLength, "cm", 10},
    Unit{Dimension::FocalLength, "m", 1e3},
};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == text.npos)
        return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// One spelling for powers: "m/s^2" is "m/s2".
std::string plain_powers(std::string_view name) {
    std::string result;
    for (const char letter : name)
        if (letter != '^')
            result += letter;
    return result;
}

std::vector<std::string> names_of_units(Dimension dimension) {
    std::vector<std::string> names;
    for (const Unit& unit : units)
        if (unit.dimension == dimension)
            names.emplace_back(unit.name);
    return names;
}

[[noreturn]] void refuse_unit(std::string_view text,
                              const std::string& name,
                              Dimension dimension) {
    std::string found = fmt::format("'{}': unknown unit '{}'", text, name);
    for (const Unit& unit : units)
        if (unit.name == name) {
            found = fmt::format(
                "'{}' is {}, not {}", text, name_of(unit.dimension), name_of(dimension));
            break;
        }
    throw assets::Error(assets::ErrorKind::Input,
                        fmt::format("{}; allowed units: {}{}",
                                    found,
                                    units_of(dimension),
                                    did_you_mean(name, names_of_units(dimension))));
}

}  // namespace

std::string name_of(Dimension dimension) {
    switch (dimension) {
        case Dimension::Number:
            return "a plain number";
        case Dimension::Length:
            return "a length";
        case Dimension::Angle:
            return "an angle";
        case Dimension::Time:
            return "a time";
        case Dimension::Rate:
            return "a rate";
        case Dimension::Velocity:
            return "a velocity";
        case Dimension::AngularVelocity:
            return "an angular velocity";
        case Dimension::Acceleration:
            return "an acceleration";
        case Dimension::Pressure:
            return "a pressure";
        case Dimension::Density:
            return "a density";
        case Dimension::Force:
            return "a force";
        case Dimension::FocalLength:
            return "a focal length";
    }
    return {};
}

std::string units_of(Dimension dimension) {
    return listed(names_of_units(dimension));
}

double parse_quantity(std::string_view text, Dimension dimension) {
    const std::string_view words = trimmed(text);
    double number = 0;
    const char* begin = words.data() + (words.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, words.data() + words.size(), number);
    if (error != std::errc{} || !std::isfinite(number))
        throw assets::Error(assets::ErrorKind::Input,
                            fmt::format("'{}' is not {}; write a number and a unit: {}",
                                        text,
                                        name_of(dimension),
                                        units_of(dimension)));

    const auto rest = words.substr(static_cast<std::size_t>(end - words.data()));
    const std::string name = plain_powers(trimmed(rest));
    if (name.empty())
        return number;
    for (const Unit& unit : units)
        if (unit.dimension == dimension && unit.name == name)
            return number * unit.times / unit.per;
    refuse_unit(text, name, dimension);
}

}  // namespace shots
