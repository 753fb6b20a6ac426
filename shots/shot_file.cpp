#include "shots/shot_file.h"

#include "shots/reading/document.h"
#include "shots/reading/readers.h"

#include <fmt/format.h>

namespace shots {
namespace {

/// Counts up whenever the same shot file would give other frames for a reason that its words do not show.
constexpr int simulation_schema = 4;

void read_words(const Table& words, Reading& reading, Shot& shot) {
    TableReader picture(words, {1, 1, {}}, "", Decides::Picture, reading);
    TableReader root(words, {1, 1, {}}, "", Decides::Simulation, reading);

    root.whole("format", 1, 1);  // the only one so far
    shot.name = picture.identifier("shot");
    shot.frames = read_frames(root);
    shot.fps = root.number("fps", Dimension::Rate, {.most = 1e6, .above = 0}, shot.fps);

    shot.scene.solver = read_solver(root.table("solver"));
    read_shapes(root.table("shapes"));
    shot.scene.bodies = read_bodies(root, shot.scene.solver, shot.render.looks);
    shot.scene.pins = read_pins(root, shot.scene.bodies);
    shot.scene.forces = read_forces(root, shot.scene.bodies);
    shot.scene.colliders = read_colliders(root, shot.frames.first, shot.fps);
    shot.scene.contact =
        read_contact(root.table("contact"), shot.scene.bodies, shot.scene.solver.steps);
    shot.scene.probes = read_probes(root, shot.scene.bodies);

    read_picture(picture, shot.scene.colliders, shot.render);
    shot.output = read_output_folder(picture, shot.name);
    root.finish_with(picture);
}

}  // namespace

Shot load_shot(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    Reading reading;
    reading.folder = file.parent_path();
    Table words = read_toml(file, reading.report);
    const bool readable = !reading.report.has_errors();
    for (const std::string& assignment : overrides)
        apply_override(assignment, words, reading.report);

    Shot shot;
    if (readable)
        read_words(words, reading, shot);
    shot.sources = SourceMap(file.string(), words);
    shot.warnings = reading.report.lines(shot.sources);
    if (reading.report.has_errors())
        throw ShotFileError(fmt::format("{}", fmt::join(shot.warnings, "\n")));

    shot.resolved = reading.resolved;
    shot.resolved["supple.version"] = SUPPLE_VERSION;
    shot.resolved["supple.schema"] = fmt::format("{}", simulation_schema);
    return shot;
}

}  // namespace shots
