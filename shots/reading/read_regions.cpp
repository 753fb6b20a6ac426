#include "shots/reading/readers.h"

#include <fmt/format.h>

namespace shots {
namespace {

const std::map<std::string, sim::Model>& models() {
    static const std::map<std::string, sim::Model> words{
        {"neo-hookean", sim::Model::NeoHookean},
        {"stable-neo-hookean", sim::Model::StableNeoHookean},
        {"fixed-corotated", sim::Model::FixedCorotated},
        {"snow", sim::Model::Snow}};
    return words;
}

std::string word_of(sim::Model model) {
    for (const auto& [word, value] : models())
        if (value == model)
            return word;
    return {};
}

/// Stretches beyond the limits stay; at a limit of 1 a point could be squashed to nothing.
void read_snow(TableReader& table, sim::SnowOptions& snow) {
    snow.hardening = table.number("hardening", Dimension::Number, not_negative, snow.hardening);
    snow.compression_limit = table.number("compression_limit",
                                          Dimension::Number,
                                          {.above = 0, .below = 1},
                                          snow.compression_limit);
    snow.stretch_limit =
        table.number("stretch_limit", Dimension::Number, positive, snow.stretch_limit);
}

void warn_of_odd_values(TableReader& table, const sim::Region& region) {
    constexpr double softest = 100;  // Pa; below it "kPa" was probably left out
    // Above it domains lock: they become too stiff in bending.
    constexpr double stiffest_nu = 0.45;
    if (table.has("young_modulus") && region.young_modulus > 0
        && region.young_modulus < softest)
        table.warning("young_modulus",
                      fmt::format("'young_modulus' is {} Pa, softer than any jelly; kPa meant?",
                                  region.young_modulus));
    if (table.has("poisson_ratio") && region.poisson_ratio > stiffest_nu)
        table.warning(
            "poisson_ratio",
            fmt::format(
                "'poisson_ratio' {} is above {}: almost incompressible bodies become too stiff",
                region.poisson_ratio,
                stiffest_nu));
}

/// `before`: the layer below, whose values are inherited; null for the first, which must give them.
sim::Region read_region(TableReader table, const sim::Region* before) {
    const auto inherited = [before](double sim::Region::*member) {
        return before != nullptr ? std::optional(before->*member) : std::nullopt;
    };
    sim::Region region = before != nullptr ? *before : sim::Region{};
    region.name = table.identifier("name");
    region.select = read_selector(table, "select");
    region.model = table.choice<sim::Model>("model",
                                            models(),
                                            {"linear-corotational",
                                             "stvk",
                                             "hencky",
                                             "mooney-rivlin",
                                             "ogden",
                                             "separable",
                                             "linear-orthotropic"},
                                            word_of(region.model));
    region.young_modulus = table.number(
        "young_modulus", Dimension::Pressure, positive, inherited(&sim::Region::young_modulus));
    region.poisson_ratio = table.number("poisson_ratio",
                                        Dimension::Number,
                                        {.above = -1, .below = 0.5},
                                        inherited(&sim::Region::poisson_ratio));
    region.density =
        table.number("density", Dimension::Density, positive, inherited(&sim::Region::density));
    if (region.model == sim::Model::Snow)
        read_snow(table, region.snow);
    region.color = table.color("color", region.color);
    warn_of_odd_values(table, region);
    table.finish();
    return region;
}

}  // namespace

std::vector<sim::Region> read_regions(TableReader& body) {
    std::vector<sim::Region> regions;
    for (TableReader& table : body.tables("region")) {
        regions.push_back(read_region(table, regions.empty() ? nullptr : &regions.back()));
        if (regions.size() == 1 && table.has("select")
            && !std::holds_alternative<sim::Selector::All>(regions.front().select.is))
            table.error("select",
                        "the first region is the ground layer: its 'select' must be \"all\"");
    }
    if (regions.empty())
        body.error(
            "region",
            fmt::format(
                "body '{0}' has no region: add [[body.{0}.region]] with select = \"all\" "
                "and its material",
                body.own_name()));
    return regions;
}

}  // namespace shots
