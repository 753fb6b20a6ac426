#include "shots/stages/simulation_tables.h"

#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"
#include "shots/stages/frame_table.h"

#include <cmath>
#include <fmt/core.h>
#include <initializer_list>

namespace shots {
namespace {

const std::string stats_header =
    "frame,time,steps,newton_iterations,cg_iterations,kinetic_energy,elastic_energy,"
    "gravitational_energy,linear_momentum_x,linear_momentum_y,linear_momentum_z,"
    "angular_momentum_x,angular_momentum_y,angular_momentum_z,total_mass,smallest_j,collider_"
    "penetration,penetration,gap,seconds";
const std::string probes_header = "frame,time,name,x,y,z,stretch,volume";
const std::string pins_header =
    "frame,time,pin,force_x,force_y,force_z,moment_x,moment_y,moment_z";

/// ",a,b,c" in the shortest form that reads back as the same double.
std::string columns(std::initializer_list<double> values) {
    std::string text;
    for (const double value : values) {
        assets::check(std::isfinite(value), "numbers in tables are finite");
        text += fmt::format(",{}", value);
    }
    return text;
}

std::string columns(const Vec3& v) {
    return columns({v.x(), v.y(), v.z()});
}

/// A text as one field: in quotes where it holds what separates fields (RFC 4180).
std::string field(const std::string& text) {
    assets::check(text.find_first_of("\r\n") == std::string::npos, "names are one line long");
    if (text.find_first_of(",\"") == std::string::npos)
        return text;
    std::string quoted;
    for (const char c : text)
        quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return '"' + quoted + '"';
}

}  // namespace

FrameRows frame_rows(int frame,
                     double time,
                     const sim::Stats& stats,
                     const std::vector<sim::ProbeRow>& probes,
                     const std::vector<sim::PinRow>& pins,
                     double seconds) {
    const std::string start = fmt::format("{}{}", frame, columns({time}));
    FrameRows rows;
    rows.stats =
        start
        + fmt::format(",{},{},{}", stats.steps, stats.newton_iterations, stats.cg_iterations)
        + columns({stats.kinetic_energy, stats.elastic_energy, stats.gravitational_energy})
        + columns(stats.linear_momentum) + columns(stats.angular_momentum)
        + columns({stats.total_mass,
                   stats.smallest_J,
                   stats.collider_penetration,
                   stats.penetration,
                   stats.gap,
                   seconds})
        + "\n";
    for (const sim::ProbeRow& probe : probes)
        rows.probes += start + "," + field(probe.name) + columns(probe.position)
                       + (probe.is_region ? columns({probe.stretch, probe.volume}) : ",,")
                       + "\n";
    for (const sim::PinRow& pin : pins)
        rows.pins +=
            start + "," + field(pin.name) + columns(pin.force) + columns(pin.moment) + "\n";
    return rows;
}

SimulationTables::SimulationTables(std::filesystem::path folder)
    : stats_(folder / "stats.csv"),
      probes_(folder / "probes.csv"),
      pins_(folder / "pins.csv") {}

bool SimulationTables::reach(int frame) const {
    // Of the three only stats.csv has rows in every shot; as it is written last, the others reach as far.
    return is_table(stats_, stats_header) && is_table(probes_, probes_header)
           && is_table(pins_, pins_header) && last_frame_in_table(stats_) >= frame;
}

void SimulationTables::cut_after(int frame) const {
    cut_table(stats_, stats_header, frame);
    cut_table(probes_, probes_header, frame);
    cut_table(pins_, pins_header, frame);
}

void SimulationTables::append(const FrameRows& rows) const {
    assets::append_flushed(probes_, rows.probes);
    assets::append_flushed(pins_, rows.pins);
    assets::append_flushed(stats_, rows.stats);
}

}  // namespace shots
