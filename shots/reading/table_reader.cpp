#include "shots/reading/table_reader.h"

#include "assets/base/error.h"
#include "shots/text/suggestion.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace shots {
namespace {

// Products of three numbers, as energies are, stay finite.
constexpr double largest_number = 1e30;

std::string as_text(const Vec3& v) {
    return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

bool holds(const Range& range, double x) {
    return x >= range.least && x <= range.most && x > range.above && x < range.below;
}

std::string allowed_numbers(const Range& range) {
    std::vector<std::string> limits;
    if (range.least > any_number.least)
        limits.push_back(fmt::format("at least {}", range.least));
    if (std::isfinite(range.above))
        limits.push_back(fmt::format("greater than {}", range.above));
    if (range.most < any_number.most)
        limits.push_back(fmt::format("at most {}", range.most));
    if (std::isfinite(range.below))
        limits.push_back(fmt::format("less than {}", range.below));
    return fmt::format("{}", fmt::join(limits, " and "));
}

}  // namespace

TableReader::TableReader(
    const Table& table, Location at, std::string key, Decides decides, Reading& reading)
    : table_(&table),
      at_(std::move(at)),
      key_(std::move(key)),
      decides_(decides),
      reading_(&reading) {}

const Value* TableReader::value(const std::string& name) {
    if (std::find(known_.begin(), known_.end(), name) == known_.end())
        known_.push_back(name);
    return find(*table_, name);
}

bool TableReader::has(const std::string& name) {
    return value(name) != nullptr;
}

std::string TableReader::key_of(const std::string& name) const {
    return key_.empty() ? name : key_ + "." + name;
}

std::string TableReader::own_name() const {
    const std::size_t dot = key_.rfind('.');
    return dot == std::string::npos ? key_ : key_.substr(dot + 1);
}

void TableReader::record(const std::string& name, const std::string& text) {
    if (decides_ == Decides::Simulation)
        reading_->resolved[key_of(name)] = text;
}

void TableReader::error(const std::string& name, const std::string& message) {
    const Value* found = find(*table_, name);
    refused_.insert(name);
    reading_->report.error(found != nullptr ? found->at : at_, message);
}

void TableReader::warning(const std::string& name, const std::string& message) {
    const Value* found = find(*table_, name);
    reading_->report.warning(found != nullptr ? found->at : at_, message);
}

const Value* TableReader::required(const std::string& name, const std::string& what) {
    const Value* found = value(name);
    if (found == nullptr)
        missing_.push_back({{name}, fmt::format("missing '{}' ({})", name, what)});
    return found;
}

void TableReader::refuse(const Value& value,
                         const std::string& name,
                         const std::string& message) {
    refused_.insert(name);
    reading_->report.error(value.at, message);
}

void TableReader::wrong_type(const Value& value,
                             const std::string& name,
                             const std::string& wanted) {
    refuse(value, name, fmt::format("'{}' must be {}; found {}", name, wanted, shown(value)));
}

bool TableReader::good(const std::string& name) const {
    return find(*table_, name) != nullptr && !refused_.contains(name);
}

void TableReader::not_available(const std::string& name) {
    if (has(name))
        error(name, fmt::format("'{}' is not available yet", name));
}

void TableReader::finish_with(const TableReader& other) {
    known_.insert(known_.end(), other.known_.begin(), other.known_.end());
    missing_.insert(missing_.end(), other.missing_.begin(), other.missing_.end());
    finish();
}

void TableReader::finish() {
    std::vector<std::string> suggested;
    for (const Entry& entry : *table_) {
        if (std::find(known_.begin(), known_.end(), entry.name) != known_.end())
            continue;
        suggested.push_back(nearest(entry.name, known_));
        reading_->report.error(entry.at,
                               fmt::format("unknown word '{}'{} (allowed here: {})",
                                           entry.name,
                                           did_you_mean(entry.name, known_),
                                           listed(known_)));
    }
    // A misspelt word is one mistake, not also a missing one.
    for (const Missing& missing : missing_)
        if (std::find_first_of(
                missing.names.begin(), missing.names.end(), suggested.begin(), suggested.end())
            == missing.names.end())
            reading_->report.error(at_, missing.message + (key_.empty() ? "" : " in " + key_));
}

std::optional<double> TableReader::number_of(const Value& value,
                                             const std::string& name,
                                             Dimension dimension,
                                             const Range& range) {
    double number = 0;
    if (const auto* whole = std::get_if<long long>(&value.is)) {
        number = static_cast<double>(*whole);
    } else if (const auto* real = std::get_if<double>(&value.is)) {
        number = *real;
    } else if (const auto* text = std::get_if<std::string>(&value.is)) {
        try {
            number = parse_quantity(*text, dimension);
        } catch (const assets::Error& error) {
            refuse(value, name, fmt::format("'{}': {}", name, error.what()));
            return {};
        }
    } else {
        wrong_type(value, name, name_of(dimension));
        return {};
    }
    if (!(std::abs(number) <= largest_number))
        wrong_type(value, name, fmt::format("from {} to {}", -largest_number, largest_number));
    else if (!holds(range, number))
        wrong_type(value, name, allowed_numbers(range));
    else
        return number;
    return {};
}

double TableReader::number(const std::string& name,
                           Dimension dimension,
                           const Range& range,
                           std::optional<double> fallback) {
    const Value* found = fallback ? value(name) : required(name, name_of(dimension));
    double result = fallback.value_or(0);
    if (found != nullptr)
        result = number_of(*found, name, dimension, range).value_or(result);
    record(name, fmt::format("{}", result));
    return result;
}

std::optional<double> TableReader::optional_number(const std::string& name,
                                                   Dimension dimension,
                                                   const Range& range) {
    if (has(name))
        return number(name, dimension, range);
    record(name, "none");
    return {};
}

int TableReader::whole(const std::string& name,
                       int least,
                       int most,
                       std::optional<int> fallback) {
    const Value* found = fallback ? value(name) : required(name, "a whole number");
    int result = fallback.value_or(least);
    if (found != nullptr) {
        const auto* number = std::get_if<long long>(&found->is);
        if (number == nullptr || *number < least || *number > most)
            wrong_type(*found, name, fmt::format("a whole number from {} to {}", least, most));
        else
            result = static_cast<int>(*number);
    }
    record(name, fmt::format("{}", result));
    return result;
}

bool TableReader::flag(const std::string& name, bool fallback) {
    bool result = fallback;
    if (const Value* found = value(name)) {
        if (const auto* given = std::get_if<bool>(&found->is))
            result = *given;
        else
            wrong_type(*found, name, "true or false");
    }
    record(name, result ? "true" : "false");
    return result;
}

std::optional<Vec3> TableReader::vector_of(const Value& value,
                                           const std::string& name,
                                           Dimension dimension,
                                           const Range& range) {
    const auto* array = std::get_if<Array>(&value.is);
    if (array == nullptr || array->size() != 3) {
        wrong_type(value, name, "an array of three, [x, y, z]");
        return {};
    }
    Vec3 result = Vec3::Zero();
    bool good = true;
    for (int i = 0; i < 3; ++i) {
        const auto component =
            number_of((*array)[static_cast<std::size_t>(i)], name, dimension, range);
        good = good && component;
        result[i] = component.value_or(0);
    }
    return good ? std::optional(result) : std::nullopt;
}

Vec3 TableReader::vector(const std::string& name,
                         Dimension dimension,
                         std::optional<Vec3> fallback) {
    const Value* found =
        fallback ? value(name) : required(name, "an array of three, [x, y, z]");
    Vec3 result = fallback.value_or(Vec3::Zero());
    if (found != nullptr)
        result = vector_of(*found, name, dimension, any_number).value_or(result);
    record(name, as_text(result));
    return result;
}

Vec3 TableReader::direction(const std::string& name) {
    const Vec3 result = vector(name, Dimension::Number);
    if (good(name) && !(result.norm() > 0))
        error(name, fmt::format("'{}' must have a length; found [0, 0, 0]", name));
    return result;
}

Vec3f TableReader::color(const std::string& name, const Vec3f& fallback) {
    Vec3f result = fallback;
    if (const Value* found = value(name))
        if (const auto given = vector_of(*found, name, Dimension::Number, fraction))
            result = given->cast<float>();
    record(name, fmt::format("[{}, {}, {}]", result.x(), result.y(), result.z()));
    return result;
}

}  // namespace shots
