#include "shots/reading/readers.h"

#include <algorithm>

namespace shots {
namespace {

/// Words that have one meaning so far: they are checked, and their other values are told to be missing.
void read_numerics(TableReader& table) {
    enum class Only { One };
    table.choice<Only>("kernel", {{"linear", Only::One}}, {"quadratic", "cubic"}, "linear");
    table.choice<Only>("quadrature", {{"one_point", Only::One}}, {"eight_point"}, "one_point");
    table.choice<Only>("elements", {{"hex", Only::One}}, {"tet"}, "hex");
    if (table.has("tolerance")) {
        table.number("tolerance", Dimension::Number, {.most = 1, .above = 0});
        table.not_available("tolerance");
    }
}

sim::EnrichmentCriteria read_criteria(TableReader& table) {
    const std::vector<std::string> words =
        table.words("enrich", {"interface", "mixed_cell", "strain"}, {}, {"interface"});
    const auto has = [&](const char* word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    return {has("interface"), has("mixed_cell"), has("strain")};
}

}  // namespace

sim::SolverOptions read_solver(TableReader table) {
    using sim::Method;
    using sim::Steps;
    sim::SolverOptions solver;
    solver.method = table.choice<Method>(
        "method",
        {{"domains", Method::Domains}, {"enriched", Method::Enriched}, {"fem", Method::Fem}},
        {"mpm", "auto"},
        "enriched");
    solver.steps = table.choice<Steps>("steps",
                                       {{"explicit", Steps::Explicit},
                                        {"semi_implicit", Steps::SemiImplicit},
                                        {"implicit", Steps::Implicit},
                                        {"bdf2", Steps::Bdf2},
                                        {"static", Steps::Static}},
                                       {},
                                       "implicit");
    if (solver.steps == Steps::Static && solver.method != Method::Fem)
        table.error(
            "steps",
            "'steps' = 'static' works with method = \"fem\" alone: set solver.method to it");
    solver.dt = table.optional_number("dt", Dimension::Time, positive);
    solver.grid_ratio = table.number(
        "grid_ratio", Dimension::Number, {.least = 1, .most = 100}, solver.grid_ratio);
    solver.damping = table.number("damping", Dimension::Rate, not_negative, solver.damping);
    solver.enrich = read_criteria(table);
    read_numerics(table);
    table.finish();
    return solver;
}

}  // namespace shots
