#include "shots/reading/readers.h"

namespace shots {
namespace {

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

assets::Shape read_shape_table(TableReader& table, const std::string& word) {
    if (word == "box")
        return read_box(table);
    if (word == "sphere")
        return assets::Sphere{table.vector("center", Dimension::Length),
                              table.number("radius", Dimension::Length, positive)};
    if (word == "cylinder")
        return read_rod<assets::Cylinder>(table);
    if (word == "capsule")
        return read_rod<assets::Capsule>(table);
    return read_torus(table);
}

/// { box = {...} } and its like; with a mesh too where `with_mesh`.
assets::Source read_geometry(TableReader table, bool with_mesh) {
    std::vector<std::string> words = shape_words();
    if (with_mesh)
        words.emplace_back("mesh");
    assets::Source source;
    const std::string word = table.one_of(words);
    if (word == "mesh")
        source.geometry = assets::MeshFile{table.file("mesh")};
    else if (!word.empty())
        source.geometry = read_shape(table, word);
    table.finish();
    return source;
}

}  // namespace

const std::vector<std::string>& shape_words() {
    static const std::vector<std::string> words{
        "box", "sphere", "cylinder", "capsule", "torus"};
    return words;
}

assets::Shape read_shape(TableReader& owner, const std::string& word) {
    TableReader table = owner.table(word);
    const assets::Shape shape = read_shape_table(table, word);
    table.finish();
    return shape;
}

assets::Transform read_transform(TableReader table) {
    assets::Transform transform;
    transform.scale = table.number("scale", Dimension::Number, positive, transform.scale);
    transform.rotate = table.vector("rotate", Dimension::Angle, transform.rotate);
    transform.translate = table.vector("translate", Dimension::Length, transform.translate);
    table.finish();
    return transform;
}

assets::Source read_body_source(TableReader& body) {
    assets::Source source;
    const std::string word = body.one_of({"shape", "mesh"});
    if (word == "shape")
        source = read_geometry(body.table("shape"), false);
    else if (word == "mesh")
        source.geometry = assets::MeshFile{body.file("mesh")};
    source.transform = read_transform(body.table("transform"));
    return source;
}

std::optional<assets::Source> read_skin_source(TableReader& skin) {
    std::optional<assets::Source> source;
    const std::string word = skin.one_of({"source", "mesh"});
    const Value* given = skin.value("source");
    if (word == "mesh")
        source = assets::Source{assets::MeshFile{skin.file("mesh")}, {}};
    else if (given != nullptr && std::holds_alternative<std::string>(given->is))
        skin.reference("source", "source", {"self"});
    else if (given != nullptr)
        source = read_geometry(skin.table("source"), true);
    if (source)
        source->transform = read_transform(skin.table("transform"));
    return source;
}

}  // namespace shots
