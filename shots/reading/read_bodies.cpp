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

/// Snow needs points, and points cannot do everything that domains can; of what [solver] says alone it tells itself.
void check_method(TableReader& table, const sim::SolverOptions& solver, const sim::Body& body) {
    using sim::Method;
    using sim::Steps;
    const Method method = method_of(solver, body);
    const std::string word = body.method ? "method" : "region";
    if (method != Method::Mpm)
        for (const sim::Region& region : body.regions)
            if (region.model == sim::Model::Snow)
                table.error(word,
                            "region '" + region.name
                                + "' is of snow, which only points can be: give body '"
                                + body.name + "' method = \"mpm\"");
    const bool differs = method != solver.method;
    if (differs && solver.steps == Steps::Static && method != Method::Fem)
        table.error(word, "'steps' = 'static' works with method = \"fem\" alone");
    if (differs && method == Method::Mpm && solver.steps == Steps::Bdf2)
        table.error(word, points_without_bdf2);
    if ((differs || body.kernel) && method == Method::Mpm && solver.steps == Steps::Explicit
        && kernel_of(solver, body) == sim::Kernel::Linear)
        table.error(body.kernel ? "kernel" : word, points_without_linear_kernel);
}

sim::Body read_body(TableReader& table, const sim::SolverOptions& solver, Looks& looks) {
    sim::Body body;
    body.name = table.own_name();
    body.source = read_body_source(table);
    body.domain_size = table.number("domain_size", Dimension::Length, positive);
    body.velocity = table.vector("velocity", Dimension::Velocity, body.velocity);
    body.spin = table.vector("spin", Dimension::AngularVelocity, body.spin);
    body.method = read_method(table, "");
    body.kernel = read_kernel(table);
    body.regions = read_regions(table);
    check_method(table, solver, body);
    body.skins = read_skins(table, looks);
    check_extent(table, body);
    table.finish();
    return body;
}

}  // namespace

std::vector<sim::Body> read_bodies(TableReader& root,
                                   const sim::SolverOptions& solver,
                                   Looks& looks) {
    std::vector<sim::Body> bodies;
    TableReader table = root.table("body");
    for (TableReader& body : table.all_tables())
        bodies.push_back(read_body(body, solver, looks));
    if (bodies.empty())
        root.error("body", "the shot has no body: add [body.NAME] with a shape or mesh");
    return bodies;
}

}  // namespace shots
