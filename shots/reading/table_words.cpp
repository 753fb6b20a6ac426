// The words and tables inside a table; table_reader.cpp reads the numbers.
#include "assets/base/error.h"
#include "shots/reading/content_hash.h"
#include "shots/reading/table_reader.h"
#include "shots/text/suggestion.h"

#include <algorithm>
#include <fmt/format.h>

namespace shots {
namespace {

const Table no_words;

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_identifier(const std::string& name) {
    constexpr std::string_view letters =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    return !name.empty() && name.find_first_not_of(letters) == std::string::npos;
}

}  // namespace

std::string TableReader::text(const std::string& name,
                              const std::optional<std::string>& fallback) {
    const Value* found = fallback ? value(name) : required(name, "a text");
    std::string result = fallback.value_or("");
    if (found != nullptr) {
        if (const auto* given = std::get_if<std::string>(&found->is))
            result = *given;
        else
            wrong_type(*found, name, "a text");
    }
    record(name, result);
    return result;
}

std::string TableReader::identifier(const std::string& name) {
    std::string result = text(name);
    const Value* found = value(name);
    if (found != nullptr && std::holds_alternative<std::string>(found->is)
        && !is_identifier(result))
        error(name,
              fmt::format(
                  "'{}' must be of letters, digits, '_' and '-'; found '{}'", name, result));
    return result;
}

bool TableReader::is_word(const Value& given,
                          const std::vector<std::string>& available,
                          const std::vector<std::string>& later,
                          const std::string& name) {
    const auto* word = std::get_if<std::string>(&given.is);
    if (word != nullptr && contains(available, *word))
        return true;
    if (word != nullptr && contains(later, *word)) {
        reading_->report.error(given.at,
                               fmt::format("'{}' = '{}' is not available yet; available: {}",
                                           name,
                                           *word,
                                           listed(available)));
        return false;
    }
    std::vector<std::string> all = available;
    all.insert(all.end(), later.begin(), later.end());
    reading_->report.error(given.at,
                           fmt::format("'{}' must be one of {}; found {}{}",
                                       name,
                                       listed(available),
                                       shown(given),
                                       word != nullptr ? did_you_mean(*word, all) : ""));
    return false;
}

std::string TableReader::word_of(const std::string& name,
                                 const std::vector<std::string>& available,
                                 const std::vector<std::string>& later,
                                 const std::string& fallback) {
    const Value* found = value(name);
    std::string result = found != nullptr && is_word(*found, available, later, name)
                             ? std::get<std::string>(found->is)
                             : fallback;
    record(name, result);
    return result;
}

std::vector<std::string> TableReader::words(const std::string& name,
                                            const std::vector<std::string>& available,
                                            const std::vector<std::string>& later,
                                            const std::vector<std::string>& fallback) {
    std::vector<std::string> result = fallback;
    if (const Value* found = value(name)) {
        const auto* array = std::get_if<Array>(&found->is);
        if (array == nullptr || array->empty())
            wrong_type(
                *found, name, fmt::format("an array of words out of {}", listed(available)));
        else
            result.clear();
        for (const Value& element : array != nullptr ? *array : Array{}) {
            if (!is_word(element, available, later, name))
                continue;
            const std::string& word = std::get<std::string>(element.is);
            if (contains(result, word))
                reading_->report.error(element.at, fmt::format("'{}' stands twice", word));
            result.push_back(word);
        }
    }
    record(name, listed(result));
    return result;
}

std::string TableReader::reference(const std::string& name,
                                   const std::string& kind,
                                   const std::vector<std::string>& known) {
    std::string result = text(name);
    const Value* found = value(name);
    if (found != nullptr && std::holds_alternative<std::string>(found->is)
        && !contains(known, result))
        error(name,
              fmt::format("there is no {} '{}'{} (there is: {})",
                          kind,
                          result,
                          did_you_mean(result, known),
                          known.empty() ? "none" : listed(known)));
    return result;
}

std::filesystem::path TableReader::file(const std::string& name) {
    const std::string given = text(name);
    if (given.empty())
        return {};
    std::filesystem::path path = (reading_->folder / given).lexically_normal();
    if (!std::filesystem::is_regular_file(path)) {
        error(name, fmt::format("there is no file '{}' (looked for {})", given, path.string()));
        return path;
    }
    try {
        if (decides_ == Decides::Simulation)
            record(name + ".content", content_hash(path));
    } catch (const assets::Error& unreadable) {
        error(name, unreadable.what());
    }
    return path;
}

std::string TableReader::one_of(const std::vector<std::string>& names) {
    std::string result;
    for (const std::string& name : names) {
        if (!has(name))
            continue;
        if (!result.empty())
            error(name,
                  fmt::format("'{}' and '{}' exclude each other: keep one", result, name));
        else
            result = name;
    }
    if (result.empty())
        missing_.push_back({names, fmt::format("missing one of {}", listed(names))});
    return result;
}

TableReader TableReader::table(const std::string& name) {
    const Value* found = value(name);
    return found != nullptr ? inside(name, *found)
                            : TableReader(no_words, at_, key_of(name), decides_, *reading_);
}

TableReader TableReader::picture_table(const std::string& name) {
    TableReader result = table(name);
    result.decides_ = Decides::Picture;
    return result;
}

TableReader TableReader::inside(const std::string& name, const Value& given) {
    const auto* table = std::get_if<Table>(&given.is);
    if (table == nullptr)
        wrong_type(given, name, "a table");
    return {table != nullptr ? *table : no_words, given.at, key_of(name), decides_, *reading_};
}

std::vector<TableReader> TableReader::tables(const std::string& name) {
    std::vector<TableReader> result;
    const Value* found = value(name);
    if (found == nullptr)
        return result;
    const auto* array = std::get_if<Array>(&found->is);
    if (array == nullptr) {
        wrong_type(*found, name, fmt::format("an array of tables: write [[{}]]", key_of(name)));
        return result;
    }
    std::vector<std::string> names;
    for (std::size_t i = 0; i < array->size(); ++i) {
        result.push_back(inside(element_key(name, (*array)[i], i), (*array)[i]));
        const std::string element = result.back().own_name();
        if (contains(names, element))
            result.back().error(
                "name",
                fmt::format("the name '{}' stands twice among {}", element, key_of(name)));
        names.push_back(element);
    }
    record(name, listed(names));
    return result;
}

std::vector<std::string> TableReader::names() {
    std::vector<std::string> result;
    for (const Entry& entry : *table_) {
        if (!is_identifier(entry.name))
            reading_->report.error(
                entry.at,
                fmt::format("names are of letters, digits, '_' and '-'; found '{}'",
                            entry.name));
        value(entry.name);
        result.push_back(entry.name);
    }
    if (decides_ == Decides::Simulation)
        reading_->resolved[key_] = listed(result);
    return result;
}

std::vector<TableReader> TableReader::all_tables() {
    std::vector<TableReader> result;
    for (const std::string& name : names())
        result.push_back(inside(name, *find(*table_, name)));
    return result;
}

}  // namespace shots
