#include "shots/reading/readers.h"
#include "shots/text/suggestion.h"

#include <algorithm>
#include <fmt/format.h>

namespace shots {
namespace {

using sim::Selector;

Selector read_value(TableReader& owner, const std::string& name, const Value& value);

Selector::HalfSpace read_half_space(TableReader table) {
    const Selector::HalfSpace half_space{table.vector("point", Dimension::Length),
                                         table.direction("normal")};
    table.finish();
    return half_space;
}

/// The array of selectors under all_of or any_of.
std::vector<Selector> read_parts(TableReader& table, const std::string& name) {
    std::vector<Selector> parts;
    const Value* value = table.value(name);
    const auto* array = std::get_if<Array>(&value->is);
    if (array == nullptr || array->empty())
        table.error(name, fmt::format("'{}' must be an array of selectors", name));
    for (std::size_t i = 0; array != nullptr && i < array->size(); ++i)
        parts.push_back(read_value(table, fmt::format("{}.{}", name, i), (*array)[i]));
    return parts;
}

decltype(Selector::is) read_word(TableReader& table, const std::string& word) {
    const std::vector<std::string>& shapes = shape_words();
    if (std::find(shapes.begin(), shapes.end(), word) != shapes.end())
        return read_shape(table, word);
    if (word == "half_space")
        return read_half_space(table.table(word));
    if (word == "mesh_material")
        return Selector::MeshMaterial{table.text(word)};
    if (word == "inside")
        return Selector::Inside{table.file(word)};
    if (word == "depth")
        return Selector::Depth{table.number(word, Dimension::Length, positive)};
    if (word == "all_of")
        return Selector::AllOf{read_parts(table, word)};
    if (word == "any_of")
        return Selector::AnyOf{read_parts(table, word)};
    if (word == "not")
        return Selector::Not{{read_value(table, word, *table.value(word))}};
    return Selector::All{};
}

/// "all", the name of a shape, or a table of exactly one word.
Selector read_value(TableReader& owner, const std::string& name, const Value& value) {
    static const std::vector<std::string> words = [] {
        std::vector<std::string> all = shape_words();
        for (const char* word :
             {"half_space", "mesh_material", "inside", "depth", "all_of", "any_of", "not"})
            all.emplace_back(word);
        return all;
    }();
    Selector selector;
    selector.key = owner.key_of(name);
    if (const auto* text = std::get_if<std::string>(&value.is)) {
        owner.record(name, *text);
        if (*text != "all")
            if (auto shape = find_shape(owner, *text, value.at))
                selector.is = std::move(*shape);
        return selector;
    }
    TableReader table = owner.inside(name, value);
    selector.is = read_word(table, table.one_of(words));
    table.finish();
    return selector;
}

}  // namespace

sim::Selector read_selector(TableReader& owner, const std::string& name) {
    const Value* value = owner.required(name, "the part of the body that is meant");
    return value != nullptr ? read_value(owner, name, *value)
                            : Selector{{}, owner.key_of(name)};
}

}  // namespace shots
