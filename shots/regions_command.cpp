#include "shots/commands.h"
#include "shots/request.h"
#include "shots/stages/progress.h"
#include "sim/enrichment/enrichment.h"
#include "sim/lattice/lattice.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shots {
namespace {

/// One row: a body, or one of its regions.
struct Row {
    std::string body, region;               // region empty: the body as a whole
    double volume = 0, mass = 0;            // [m³], [kg]
    int domains = 0, boundary_domains = 0;  // those with a face neighbour of another region
    double young_modulus = 0, poisson_ratio = 0, density = 0;  // of regions
};

std::vector<Row> rows_of(const sim::Body& body, const sim::Lattice& lattice) {
    std::vector<Row> rows(1 + body.regions.size());
    for (std::size_t r = 0; r < body.regions.size(); ++r) {
        const sim::Region& region = body.regions[r];
        rows[r + 1] = {body.name,
                       region.name,
                       lattice.region_volume[r],
                       lattice.region_mass[r],
                       0,
                       0,
                       region.young_modulus,
                       region.poisson_ratio,
                       region.density};
    }
    for (const int region : lattice.region)
        ++rows[static_cast<std::size_t>(region) + 1].domains;
    for (const int domain : sim::boundary_domains(lattice))
        ++rows[static_cast<std::size_t>(lattice.region[static_cast<std::size_t>(domain)]) + 1]
              .boundary_domains;

    Row& total = rows.front();
    total.body = body.name;
    for (std::size_t r = 1; r < rows.size(); ++r) {
        total.volume += rows[r].volume;
        total.mass += rows[r].mass;
        total.domains += rows[r].domains;
        total.boundary_domains += rows[r].boundary_domains;
    }
    return rows;
}

/// "1.5 MPa": the largest unit that leaves at least 1 before the point.
std::string pressure_text(double pascal) {
    for (const auto& [factor, unit] : {std::pair{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}})
        if (pascal >= factor)
            return fmt::format("{:.4g} {}", pascal / factor, unit);
    return fmt::format("{:.4g} Pa", pascal);
}

std::string percent(int part, int whole) {
    return fmt::format("{:.1f} %", whole > 0 ? 100.0 * part / whole : 0);
}

void print_table(const std::vector<Row>& rows) {
    constexpr const char* line = "{:<24}{:>13}{:>13}{:>10}{:>11}{:>12}{:>9}{:>11}\n";
    fmt::print(line,
               "body / region",
               "volume m3",
               "mass kg",
               "domains",
               "boundary",
               "modulus",
               "poisson",
               "kg/m3");
    for (const Row& row : rows) {
        const bool is_body = row.region.empty();
        fmt::print(line,
                   is_body ? row.body : "  " + row.region,
                   fmt::format("{:.5g}", row.volume),
                   fmt::format("{:.5g}", row.mass),
                   row.domains,
                   percent(row.boundary_domains, row.domains),
                   is_body ? "" : pressure_text(row.young_modulus),
                   is_body ? "" : fmt::format("{:.4g}", row.poisson_ratio),
                   is_body ? "" : fmt::format("{:.5g}", row.density));
    }
}

void print_json(const Row& row) {
    nlohmann::json line{{"body", row.body},
                        {"volume", row.volume},
                        {"mass", row.mass},
                        {"domains", row.domains},
                        {"boundary_domains", row.boundary_domains}};
    if (!row.region.empty())
        line.update({{"region", row.region},
                     {"young_modulus", row.young_modulus},
                     {"poisson_ratio", row.poisson_ratio},
                     {"density", row.density}});
    fmt::print("{}\n", line.dump());
}

}  // namespace

void regions_command(const Request& request) {
    const Shot shot = requested_shot(request);
    Progress progress(progress_style(request.quiet));
    std::vector<Row> rows;
    with_places(shot, [&] {
        for (const sim::Body& body : shot.scene.bodies) {
            std::vector<std::string> notes;
            const sim::Slivers slivers = sim::slivers_for(method_of(shot.scene.solver, body));
            const auto of_body = rows_of(body, sim::make_lattice(body, &notes, slivers));
            rows.insert(rows.end(), of_body.begin(), of_body.end());
            for (const std::string& note : notes)
                progress.say("note: " + note);
        }
    });
    if (!request.json)
        print_table(rows);
    else
        std::for_each(rows.begin(), rows.end(), print_json);
}

}  // namespace shots
