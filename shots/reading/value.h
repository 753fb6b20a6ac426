// A shot file as a tree of plain values that know where they stand. Nothing beyond this folder sees the TOML library.
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace shots {

/// Where something was written: in the file, or in an option "--set key=value".
struct Location {
    int line = 0, column = 0;  // from 1; 0 where `option` says the place
    std::string option;        // "--set solver.dt=1" or empty
};

struct Entry;
struct Value;
using Array = std::vector<Value>;
using Table = std::vector<Entry>;  // in the order of the file

struct Value {
    std::variant<bool, long long, double, std::string, Array, Table> is;
    Location at;
};

struct Entry {
    std::string name;
    Location at;  // of the name
    Value value;
};

/// The value of `name`, or null.
const Value* find(const Table& table, const std::string& name);

/// What a value is, for messages: "a number", "a table", ...
std::string kind_of(const Value& value);

/// A value as a message shows it: "'25 mm'", "0.5", "true", or its kind where it is long.
std::string shown(const Value& value);

/// Dotted key of element `index` of an array of tables: by its name where it has one ("pin.wall"), else by its
/// index ("collider.0").
std::string element_key(const std::string& array_key, const Value& element, std::size_t index);

}  // namespace shots
