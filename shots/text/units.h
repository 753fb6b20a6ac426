// Quantities as text: "200 kPa", "25 mm", "30 deg".
#pragma once

#include <string>
#include <string_view>

namespace shots {

enum class Dimension {
    Number,  // without a unit, or in %
    Length,
    Angle,
    Time,
    Rate,
    Velocity,
    AngularVelocity,
    Acceleration,
    Pressure,
    Density,
    Force,
    FocalLength,  // bare numbers are mm
};

/// The dimension as messages name it: "a pressure".
std::string name_of(Dimension dimension);

/// The units of a dimension, "Pa, kPa, MPa, GPa".
std::string units_of(Dimension dimension);

/// The value of "200 kPa" in SI units (focal lengths in mm); a number without a unit is taken to be in them already.
/// Throws assets::Error(Input) saying which units are allowed, or of which dimension the unit found is.
double parse_quantity(std::string_view text, Dimension dimension);

}  // namespace shots
