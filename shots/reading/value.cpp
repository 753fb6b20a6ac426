#include "shots/reading/value.h"

#include <array>
#include <fmt/format.h>

namespace shots {

const Value* find(const Table& table, const std::string& name) {
    for (const Entry& entry : table)
        if (entry.name == name)
            return &entry.value;
    return nullptr;
}

std::string kind_of(const Value& value) {
    constexpr std::array kinds{
        "true or false", "a whole number", "a number", "a text", "an array", "a table"};
    return kinds[value.is.index()];
}

std::string shown(const Value& value) {
    if (const auto* flag = std::get_if<bool>(&value.is))
        return *flag ? "true" : "false";
    if (const auto* whole = std::get_if<long long>(&value.is))
        return fmt::format("{}", *whole);
    if (const auto* number = std::get_if<double>(&value.is))
        return fmt::format("{}", *number);
    if (const auto* text = std::get_if<std::string>(&value.is))
        return fmt::format("'{}'", *text);
    return kind_of(value);
}

std::string element_key(const std::string& array_key, const Value& element, std::size_t index) {
    if (const auto* table = std::get_if<Table>(&element.is))
        if (const Value* name = find(*table, "name"))
            if (const auto* text = std::get_if<std::string>(&name->is))
                return array_key + "." + *text;
    return fmt::format("{}.{}", array_key, index);
}

}  // namespace shots
