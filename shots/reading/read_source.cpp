#include "shots/reading/readers.h"

namespace shots {
namespace {

/// A shape by itself or by name, or { mesh = "file" }.
assets::Source read_shape_or_mesh(TableReader& owner, const std::string& name) {
    const Value* value = owner.value(name);
    const auto* table = std::get_if<Table>(&value->is);
    if (table == nullptr || find(*table, "mesh") == nullptr)
        return {read_shape_value(owner, name, *value), {}};
    TableReader mesh = owner.inside(name, *value);
    const assets::MeshFile file{mesh.file("mesh")};
    mesh.finish();
    return {file, {}};
}

}  // namespace

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
        source.geometry = read_shape_value(body, "shape", *body.value("shape"));
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
    else if (const auto* name = given ? std::get_if<std::string>(&given->is) : nullptr;
             name != nullptr && *name == "self")
        skin.record("source", *name);
    else if (given != nullptr)
        source = read_shape_or_mesh(skin, "source");
    if (source)
        source->transform = read_transform(skin.table("transform"));
    return source;
}

}  // namespace shots
