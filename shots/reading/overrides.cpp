#include "shots/reading/document.h"
#include "shots/text/suggestion.h"

#include <fmt/format.h>

namespace shots {
namespace {

/// The value that one part of a dotted key names, inside a table or an array of tables; null where there is none.
Value* child(Value& parent, const std::string& name) {
    if (auto* table = std::get_if<Table>(&parent.is)) {
        for (Entry& entry : *table)
            if (entry.name == name)
                return &entry.value;
    } else if (auto* array = std::get_if<Array>(&parent.is)) {
        for (std::size_t i = 0; i < array->size(); ++i)
            if (element_key("", (*array)[i], i) == "." + name || std::to_string(i) == name)
                return &(*array)[i];
    }
    return nullptr;
}

std::vector<std::string> names_inside(const Value& parent) {
    std::vector<std::string> names;
    if (const auto* table = std::get_if<Table>(&parent.is))
        for (const Entry& entry : *table)
            names.push_back(entry.name);
    if (const auto* array = std::get_if<Array>(&parent.is))
        for (std::size_t i = 0; i < array->size(); ++i)
            names.push_back(element_key("", (*array)[i], i).substr(1));
    return names;
}

/// child(), added as an empty table where a table does not hold it; null and a report where it cannot be.
Value* child_or_new(Value& parent,
                    const std::string& name,
                    const Location& at,
                    Report& report) {
    if (Value* found = child(parent, name))
        return found;
    if (auto* table = std::get_if<Table>(&parent.is)) {
        table->push_back({name, at, {Table{}, at}});
        return &table->back().value;
    }
    const auto names = names_inside(parent);
    report.error(
        at,
        std::holds_alternative<Array>(parent.is)
            ? fmt::format("there is no '{}'{} (there is: {})",
                          name,
                          did_you_mean(name, names),
                          listed(names))
            : fmt::format("'{}' lies inside {}, which holds no words", name, kind_of(parent)));
    return nullptr;
}

}  // namespace

void apply_override(const std::string& assignment, Table& root, Report& report) {
    const std::size_t equals = assignment.find('=');
    const Location at{0, 0, "--set " + assignment};
    if (equals == std::string::npos || equals == 0) {
        report.error(at, "write --set key.path=value, as in --set solver.dt=\"0.5 ms\"");
        return;
    }

    Value tree{std::move(root), {}};
    Value* place = &tree;
    const std::string key = assignment.substr(0, equals);
    for (std::size_t begin = 0; place != nullptr && begin <= key.size();) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        place = child_or_new(*place, key.substr(begin, end - begin), at, report);
        begin = end + 1;
    }
    if (place != nullptr)
        *place = parse_override_value(assignment.substr(equals + 1), at);
    root = std::move(std::get<Table>(tree.is));
}

}  // namespace shots
