#include "shots/reading/readers.h"

namespace shots {
namespace {

render::Look read_look(TableReader table) {
    using render::ColorBy;
    render::Look look;
    if (table.has("color") && table.has("color_by"))
        table.error("color_by", "'color' and 'color_by' exclude each other: keep one");
    if (table.has("color")) {
        look.color = table.color("color", look.color);
        look.color_by = ColorBy::Look;
    }
    if (table.has("color_by"))
        look.color_by =
            table.choice<ColorBy>("color_by",
                                  {{"region", ColorBy::Region}, {"stretch", ColorBy::Stretch}},
                                  {"stress"},
                                  "region");
    look.coated = table.flag("coated", look.coated);
    if (!look.coated && table.has("roughness"))
        table.error("roughness",
                    "'roughness' is the coat's: leave it out where 'coated' = false");
    look.roughness = static_cast<float>(
        table.number("roughness", Dimension::Number, fraction, look.roughness));
    look.opacity =
        static_cast<float>(table.number("opacity", Dimension::Number, fraction, look.opacity));
    table.finish();
    return look;
}

std::vector<sim::Skin> read_skins(TableReader& body, Looks& looks) {
    std::vector<sim::Skin> skins;
    for (TableReader& table : body.tables("skin")) {
        sim::Skin skin;
        skin.name = table.identifier("name");
        skin.source = read_skin_source(table);
        looks[{body.own_name(), skin.name}] = read_look(table.picture_table("look"));
        table.finish();
        skins.push_back(std::move(skin));
    }
    if (skins.empty()) {
        skins.push_back({"self", {}});
        looks[{body.own_name(), "self"}] = {};
    }
    return skins;
}

sim::Body read_body(TableReader& table, Looks& looks) {
    sim::Body body;
    body.name = table.own_name();
    body.source = read_body_source(table);
    body.domain_size = table.number("domain_size", Dimension::Length, positive);
    body.velocity = table.vector("velocity", Dimension::Velocity, body.velocity);
    body.spin = table.vector("spin", Dimension::AngularVelocity, body.spin);
    body.regions = read_regions(table);
    body.skins = read_skins(table, looks);
    check_extent(table, body);
    table.finish();
    return body;
}

}  // namespace

std::vector<sim::Body> read_bodies(TableReader& root, Looks& looks) {
    std::vector<sim::Body> bodies;
    TableReader table = root.table("body");
    for (TableReader& body : table.all_tables())
        bodies.push_back(read_body(body, looks));
    if (bodies.empty())
        root.error("body", "the shot has no body: add [body.NAME] with a shape or mesh");
    return bodies;
}

}  // namespace shots
