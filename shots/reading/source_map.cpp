#include "shots/reading/source_map.h"

#include <fmt/format.h>
#include <utility>

namespace shots {

SourceMap::SourceMap(std::string file, const Table& root) : file_(std::move(file)) {
    for (const Entry& entry : root)
        add(entry.name, entry.value);
}

void SourceMap::add(const std::string& key, const Value& value) {
    places_.emplace(key, value.at);
    if (const auto* table = std::get_if<Table>(&value.is))
        for (const Entry& entry : *table)
            add(key + "." + entry.name, entry.value);
    if (const auto* array = std::get_if<Array>(&value.is))
        for (std::size_t i = 0; i < array->size(); ++i)
            add(element_key(key, (*array)[i], i), (*array)[i]);
}

std::string SourceMap::place(std::string key) const {
    while (!key.empty()) {
        if (const auto found = places_.find(key); found != places_.end())
            return text(found->second);
        const std::size_t dot = key.rfind('.');
        key.resize(dot == std::string::npos ? 0 : dot);
    }
    return file_;
}

std::string SourceMap::text(const Location& at) const {
    if (!at.option.empty())
        return at.option;
    return at.line > 0 ? fmt::format("{}:{}:{}", file_, at.line, at.column) : file_;
}

}  // namespace shots
