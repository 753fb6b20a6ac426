#include "shots/reading/document.h"

#include "assets/base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <toml++/toml.h>
#include <tuple>

namespace shots {
namespace {

Location location_of(const toml::source_region& source) {
    return {static_cast<int>(source.begin.line), static_cast<int>(source.begin.column), {}};
}

Value converted(const toml::node& node, Report& report);

Table converted_table(const toml::table& source, Report& report) {
    Table table;
    for (const auto& [key, node] : source)
        table.push_back(
            {std::string(key.str()), location_of(key.source()), converted(node, report)});
    std::stable_sort(table.begin(), table.end(), [](const Entry& a, const Entry& b) {
        return std::tie(a.at.line, a.at.column) < std::tie(b.at.line, b.at.column);
    });
    return table;
}

Array converted_array(const toml::array& source, Report& report) {
    Array array;
    for (const toml::node& node : source)
        array.push_back(converted(node, report));
    return array;
}

Value converted(const toml::node& node, Report& report) {
    const Location at = location_of(node.source());
    if (const auto* table = node.as_table())
        return {converted_table(*table, report), at};
    if (const auto* array = node.as_array())
        return {converted_array(*array, report), at};
    if (const auto* text = node.as_string())
        return {text->get(), at};
    if (const auto* whole = node.as_integer())
        return {static_cast<long long>(whole->get()), at};
    if (const auto* number = node.as_floating_point())
        return {number->get(), at};
    if (const auto* flag = node.as_boolean())
        return {flag->get(), at};
    report.error(at, "dates and times have no meaning in a shot file");
    return {std::string{}, at};
}

/// Gives a value and all inside it the place of the option that set it.
void relocate(Value& value, const Location& at) {
    value.at = at;
    if (auto* array = std::get_if<Array>(&value.is))
        for (Value& element : *array)
            relocate(element, at);
    if (auto* table = std::get_if<Table>(&value.is))
        for (Entry& entry : *table) {
            entry.at = at;
            relocate(entry.value, at);
        }
}

}  // namespace

Table read_toml(const std::filesystem::path& file, Report& report) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file))
        throw assets::Error(assets::ErrorKind::Input,
                            fmt::format("cannot read the shot file '{}'", file.string()));
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    try {
        return converted_table(toml::parse(text), report);
    } catch (const toml::parse_error& error) {
        report.error(location_of(error.source()), std::string(error.description()));
        return {};
    }
}

Value parse_override_value(const std::string& text, const Location& at) {
    try {
        const toml::table table = toml::parse("value = " + text);
        Report report;
        Value value = converted(*table.get("value"), report);
        if (table.size() == 1 && !report.has_errors()) {
            relocate(value, at);
            return value;
        }
    } catch (const toml::parse_error&) {  // no TOML value: a text
    }
    return {text, at};
}

}  // namespace shots
