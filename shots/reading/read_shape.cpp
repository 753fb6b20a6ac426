// Shapes: primitives, and what they combine to.
#include "shots/reading/readers.h"
#include "shots/text/suggestion.h"

#include <fmt/format.h>

namespace shots {
namespace {

using assets::Combination;

assets::Box read_box(TableReader& table) {
    const assets::Box box{table.vector("min", Dimension::Length),
                          table.vector("max", Dimension::Length)};
    if (table.good("min") && table.good("max") && !(box.min.array() < box.max.array()).all())
        table.error("max", "'max' must be greater than 'min' along x, y and z");
    return box;
}

template <typename Rod>  // Cylinder or Capsule
Rod read_rod(TableReader& table) {
    const Rod rod{table.vector("from", Dimension::Length),
                  table.vector("to", Dimension::Length),
                  table.number("radius", Dimension::Length, positive)};
    if (table.good("from") && table.good("to") && rod.from == rod.to)
        table.error("to", "'from' and 'to' are the same point");
    return rod;
}

assets::Torus read_torus(TableReader& table) {
    const assets::Torus torus{table.vector("center", Dimension::Length),
                              table.direction("axis"),
                              table.number("major", Dimension::Length, positive),
                              table.number("minor", Dimension::Length, positive)};
    if (table.good("major") && table.good("minor") && torus.minor >= torus.major)
        table.error("minor", "'minor' must be less than 'major'");
    return torus;
}

assets::Ellipsoid read_ellipsoid(TableReader& table) {
    const assets::Ellipsoid ellipsoid{table.vector("center", Dimension::Length),
                                      table.vector("radii", Dimension::Length)};
    if (table.good("radii") && !(ellipsoid.radii.array() > 0).all())
        table.error("radii", "'radii' must be greater than 0, all three");
    return ellipsoid;
}

assets::Shape read_primitive(TableReader table, const std::string& word) {
    assets::Shape shape;
    if (word == "box")
        shape = read_box(table);
    else if (word == "sphere")
        shape = assets::Sphere{table.vector("center", Dimension::Length),
                               table.number("radius", Dimension::Length, positive)};
    else if (word == "cylinder")
        shape = read_rod<assets::Cylinder>(table);
    else if (word == "capsule")
        shape = read_rod<assets::Capsule>(table);
    else if (word == "torus")
        shape = read_torus(table);
    else
        shape = read_ellipsoid(table);
    table.finish();
    return shape;
}

/// What stands where a mistake was reported.
assets::Shape no_shape() {
    return assets::Sphere{};
}

/// union = [...], intersection = [...] or difference = [...], and smooth.
Combination read_combination(TableReader& table,
                             const std::string& word,
                             Combination::Kind kind) {
    Combination combination{kind, {}, 0};
    combination.smooth = table.number("smooth", Dimension::Length, not_negative, 0.0);
    const Value* value = table.value(word);
    const auto* array = std::get_if<Array>(&value->is);
    if (array == nullptr || array->empty()) {
        table.error(word, fmt::format("'{}' must be an array of shapes", word));
        return {kind, {{no_shape()}}, 0};
    }
    for (std::size_t i = 0; i < array->size(); ++i)
        combination.of.push_back(
            {read_shape_value(table, fmt::format("{}.{}", word, i), (*array)[i])});
    return combination;
}

}  // namespace

const std::vector<std::string>& shape_words() {
    static const std::vector<std::string> words{"box",
                                                "sphere",
                                                "cylinder",
                                                "capsule",
                                                "torus",
                                                "ellipsoid",
                                                "union",
                                                "intersection",
                                                "difference",
                                                "moved",
                                                "mirror",
                                                "ring"};
    return words;
}

assets::Shape read_shape(TableReader& owner, const std::string& word) {
    constexpr int most_in_a_ring = 1000;
    const auto original = [&] { return read_shape_value(owner, word, *owner.value(word)); };
    if (word == "union")
        return read_combination(owner, word, Combination::Kind::Union);
    if (word == "intersection")
        return read_combination(owner, word, Combination::Kind::Intersection);
    if (word == "difference")
        return read_combination(owner, word, Combination::Kind::Difference);
    if (word == "moved") {
        const Vec3 none = Vec3::Zero();
        const Vec3 rotate = owner.vector("rotate", Dimension::Angle, none);
        return assets::moved(
            original(), rotate, owner.vector("translate", Dimension::Length, none));
    }
    if (word == "mirror") {
        const Vec3 point = owner.vector("point", Dimension::Length);
        return assets::mirrored(original(), point, owner.direction("normal"));
    }
    if (word == "ring") {
        const Vec3 point = owner.vector("point", Dimension::Length);
        const Vec3 axis = owner.direction("axis");
        return assets::ring_of(
            original(), point, axis, owner.whole("count", 1, most_in_a_ring));
    }
    return read_primitive(owner.table(word), word);
}

std::optional<assets::Shape> find_shape(TableReader& owner,
                                        const std::string& given,
                                        const Location& at) {
    const auto& shapes = owner.reading().shapes;
    if (const auto found = shapes.find(given); found != shapes.end())
        return found->second;
    std::vector<std::string> known;
    for (const auto& [name, shape] : shapes)
        known.push_back(name);
    owner.reading().report.error(at,
                                 fmt::format("there is no shape '{}'{} ([shapes] has: {})",
                                             given,
                                             did_you_mean(given, known),
                                             known.empty() ? "none" : listed(known)));
    return {};
}

assets::Shape read_shape_value(TableReader& owner,
                               const std::string& name,
                               const Value& value) {
    if (const auto* given = std::get_if<std::string>(&value.is)) {
        owner.record(name, *given);
        return find_shape(owner, *given, value.at).value_or(no_shape());
    }
    TableReader table = owner.inside(name, value);
    if (!std::holds_alternative<Table>(value.is))
        return no_shape();
    const std::string word = table.one_of(shape_words());
    assets::Shape shape = word.empty() ? no_shape() : read_shape(table, word);
    table.finish();
    return shape;
}

void read_shapes(TableReader table) {
    for (const std::string& name : table.names()) {
        if (name == "all" || name == "self")
            table.error(name,
                        fmt::format("'{}' has a meaning of its own: take another name", name));
        assets::Shape shape = read_shape_value(table, name, *table.value(name));
        table.reading().shapes.insert_or_assign(name, std::move(shape));
    }
}

}  // namespace shots
