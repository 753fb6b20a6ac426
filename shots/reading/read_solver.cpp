#include "shots/reading/readers.h"

#include <algorithm>

namespace shots {
namespace {

/// Words that have one meaning so far: they are checked, and their other values are told to be missing.
void read_numerics(TableReader& table) {
    enum class Only { One };
    table.choice<Only>("elements", {{"hex", Only::One}}, {"tet"}, "hex");
    if (table.has("tolerance")) {
        table.number("tolerance", Dimension::Number, {.most = 1, .above = 0});
        table.not_available("tolerance");
    }
}

sim::EnrichmentCriteria read_criteria(TableReader& table) {
    const std::vector<std::string> words = table.words(
        "enrich", {"interface", "thin", "mixed_cell", "strain"}, {}, {"interface", "thin"});
    const auto has = [&](const char* word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    return {has("interface"), has("thin"), has("mixed_cell"), has("strain")};
}

}  // namespace

std::optional<sim::Method> read_method(TableReader& table, const std::string& usual) {
    using sim::Method;
    if (usual.empty() && !table.has("method"))
        return {};
    return table.choice<Method>("method",
                                {{"mpm", Method::Mpm},
                                 {"domains", Method::Domains},
                                 {"enriched", Method::Enriched},
                                 {"fem", Method::Fem}},
                                {"auto"},
                                usual.empty() ? "enriched" : usual);
}

std::optional<sim::Kernel> read_kernel(TableReader& table) {
    using sim::Kernel;
    if (!table.has("kernel"))
        return {};
    return table.choice<Kernel>("kernel",
                                {{"linear", Kernel::Linear},
                                 {"quadratic", Kernel::Quadratic},
                                 {"cubic", Kernel::Cubic}},
                                {},
                                "linear");
}

sim::SolverOptions read_solver(TableReader table) {
    using sim::Quadrature;
    using sim::Steps;
    using sim::Transfer;
    sim::SolverOptions solver;
    solver.method = *read_method(table, "enriched");
    solver.kernel = read_kernel(table);
    solver.transfer = table.choice<Transfer>(
        "transfer", {{"flip", Transfer::Flip}, {"apic", Transfer::Apic}}, {}, "flip");
    solver.pic_rate = table.number("pic_rate", Dimension::Rate, not_negative, solver.pic_rate);
    solver.steps = table.choice<Steps>("steps",
                                       {{"explicit", Steps::Explicit},
                                        {"semi_implicit", Steps::SemiImplicit},
                                        {"implicit", Steps::Implicit},
                                        {"bdf2", Steps::Bdf2},
                                        {"static", Steps::Static}},
                                       {},
                                       "implicit");
    if (solver.method == sim::Method::Mpm && solver.steps == Steps::Bdf2)
        table.error("steps", points_without_bdf2);
    if (solver.method == sim::Method::Mpm && solver.steps == Steps::Explicit
        && solver.kernel == sim::Kernel::Linear)
        table.error("kernel", points_without_linear_kernel);
    if (solver.steps == Steps::Bdf2 && solver.transfer == Transfer::Apic)
        table.error(
            "transfer",
            "'transfer' = 'apic' takes the velocities of one step, 'steps' = 'bdf2' those "
            "of two: use 'flip', or other steps");
    if (solver.steps == Steps::Static && solver.method != sim::Method::Fem)
        table.error(
            "steps",
            "'steps' = 'static' works with method = \"fem\" alone: set solver.method to it");
    solver.dt = table.optional_number("dt", Dimension::Time, positive);
    solver.grid_ratio = table.number(
        "grid_ratio", Dimension::Number, {.least = 1, .most = 100}, solver.grid_ratio);
    solver.damping = table.number("damping", Dimension::Rate, not_negative, solver.damping);
    solver.enrich = read_criteria(table);
    solver.quadrature = table.choice<Quadrature>(
        "quadrature",
        {{"one_point", Quadrature::OnePoint}, {"eight_point", Quadrature::EightPoint}},
        {},
        "one_point");
    read_numerics(table);
    table.finish();
    return solver;
}

}  // namespace shots
