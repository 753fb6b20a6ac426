// What acts on bodies, and what is measured on them: pins, forces, probes.
#include "shots/reading/readers.h"

#include <algorithm>

namespace shots {
namespace {

std::array<bool, 3> read_axes(TableReader& table, const std::string& name) {
    const std::vector<std::string> axes{"x", "y", "z"};
    const std::vector<std::string> given = table.words(name, axes, {}, axes);
    std::array<bool, 3> result{};
    for (std::size_t i = 0; i < axes.size(); ++i)
        result[i] = std::find(given.begin(), given.end(), axes[i]) != given.end();
    return result;
}

sim::Pin::Spin read_spin(TableReader table) {
    const sim::Pin::Spin spin{table.direction("axis"),
                              table.vector("point", Dimension::Length),
                              table.number("rate", Dimension::AngularVelocity, any_number)};
    table.finish();
    return spin;
}

sim::Pin read_pin(TableReader& table, const std::vector<sim::Body>& bodies) {
    sim::Pin pin;
    pin.name = table.identifier("name");
    pin.body = table.reference("body", "body", names_of(bodies));
    pin.select = read_selector(table, "select");
    if (table.has("velocity") && table.has("spin"))
        table.error("spin", "'velocity' and 'spin' exclude each other: keep one");
    if (table.has("velocity"))
        pin.moves = sim::Pin::Velocity{table.vector("velocity", Dimension::Velocity)};
    else if (table.has("spin"))
        pin.moves = read_spin(table.table("spin"));
    pin.until = table.optional_number("until", Dimension::Time, positive).value_or(pin.until);
    pin.only = read_axes(table, "only");
    table.finish();
    return pin;
}

sim::Force read_force(TableReader& table, const std::vector<sim::Body>& bodies) {
    sim::Force force;
    const std::string word = table.one_of({"gravity", "total"});
    if (word == "gravity") {
        force = sim::Gravity{table.vector("gravity", Dimension::Acceleration)};
        for (const char* part : {"body", "select"})
            if (table.has(part))
                table.error(part, "gravity acts on all bodies: leave 'body' and 'select' out");
    } else if (word == "total" || table.has("body") || table.has("select")) {
        sim::DeadLoad load;
        load.body = table.reference("body", "body", names_of(bodies));
        load.select = read_selector(table, "select");
        if (word == "total")
            load.total = table.vector("total", Dimension::Force);
        force = load;
    }
    table.finish();
    return force;
}

sim::Probe read_probe(TableReader& table, const std::vector<sim::Body>& bodies) {
    sim::Probe probe;
    probe.name = table.identifier("name");
    probe.body = table.reference("body", "body", names_of(bodies));
    if (table.one_of({"point", "region"}) == "point")
        probe.at = table.vector("point", Dimension::Length);
    else
        for (const sim::Body& body : bodies)
            if (body.name == probe.body && table.has("region"))
                probe.at = table.reference("region", "region", names_of(body.regions));
    table.finish();
    return probe;
}

}  // namespace

std::vector<sim::Pin> read_pins(TableReader& root, const std::vector<sim::Body>& bodies) {
    std::vector<sim::Pin> pins;
    for (TableReader& table : root.tables("pin"))
        pins.push_back(read_pin(table, bodies));
    return pins;
}

std::vector<sim::Force> read_forces(TableReader& root, const std::vector<sim::Body>& bodies) {
    std::vector<sim::Force> forces;
    for (TableReader& table : root.tables("force"))
        forces.push_back(read_force(table, bodies));
    return forces;
}

std::vector<sim::Probe> read_probes(TableReader& root, const std::vector<sim::Body>& bodies) {
    std::vector<sim::Probe> probes;
    for (TableReader& table : root.tables("probe"))
        probes.push_back(read_probe(table, bodies));
    return probes;
}

}  // namespace shots
