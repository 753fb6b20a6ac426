// The text of a shot file, and overrides, as a tree of values.
#pragma once

#include "shots/reading/report.h"
#include "shots/reading/value.h"

#include <filesystem>
#include <string>
#include <vector>

namespace shots {

/// Reads a TOML file. Mistakes of syntax go into `report`; the tree is empty then. Throws assets::Error(Input)
/// where the file cannot be read.
Table read_toml(const std::filesystem::path& file, Report& report);

/// The value of "key.path=value" as TOML reads it ("2e5", "[0, 0, 1]", "true"); whatever is no TOML value is a text,
/// so that quotes may be left out ("fem", "200 kPa").
Value parse_override_value(const std::string& text, const Location& at);

/// Sets "key.path=value" in the tree, by the dotted keys of SourceMap; keys that the file leaves out are added.
/// A path through what is no table, or to an element that no array holds, goes into `report`.
void apply_override(const std::string& assignment, Table& root, Report& report);

}  // namespace shots
