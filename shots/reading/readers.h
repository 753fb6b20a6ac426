// One reader per table of the shot file's vocabulary. All follow TableReader: mistakes go into the report.
#pragma once

#include "assets/generators/shape.h"
#include "render/options.h"
#include "shots/reading/table_reader.h"
#include "shots/text/frame_range.h"
#include "sim/scene.h"

#include <string>
#include <vector>

namespace shots {

/// The names of things that have one.
template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& things) {
    std::vector<std::string> names;
    for (const Named& thing : things)
        names.push_back(thing.name);
    return names;
}

/// What points cannot do, for messages.
inline constexpr const char* points_without_bdf2 =
    "'steps' = 'bdf2' cannot move points: use implicit, semi_implicit or explicit";
inline constexpr const char* points_without_linear_kernel =
    "explicit steps of points need a quadratic or cubic kernel: a linear one gives full forces "
    "to nodes of next to no mass";

/// [solver]
sim::SolverOptions read_solver(TableReader table);

/// method, one of the words of [solver]; empty where there is none and `usual` is empty.
std::optional<sim::Method> read_method(TableReader& table, const std::string& usual);

/// kernel; empty where there is none.
std::optional<sim::Kernel> read_kernel(TableReader& table);

/// The words that make a shape: box, sphere, cylinder, capsule, torus, ellipsoid, union, intersection, difference,
/// moved, mirror, ring.
const std::vector<std::string>& shape_words();

/// The shape that the word of shape_words() makes in `owner`, with the words beside it that belong to it.
assets::Shape read_shape(TableReader& owner, const std::string& word);

/// A shape that stands as a value in `owner` under `name`: { WORD = ... }, or the name of one of [shapes].
assets::Shape read_shape_value(TableReader& owner, const std::string& name, const Value& value);

/// The shape of [shapes] that `given` names; empty and a report where there is none.
std::optional<assets::Shape> find_shape(TableReader& owner,
                                        const std::string& given,
                                        const Location& at);

/// [shapes]: named shapes, in the order of the file; each may use those before it.
void read_shapes(TableReader table);

/// shape = {...} or mesh = "file", and transform = {...}, in the table of a body.
assets::Source read_body_source(TableReader& body);

/// source = "self" (empty) | {shape or mesh}, or mesh = "file"; and transform = {...}, in the table of a skin.
std::optional<assets::Source> read_skin_source(TableReader& skin);

/// { scale, rotate, translate }
assets::Transform read_transform(TableReader table);

/// The selector that stands in `owner` under `name`. Required.
sim::Selector read_selector(TableReader& owner, const std::string& name);

/// All [[body.NAME.region]], each inheriting from the one before what it leaves out.
std::vector<sim::Region> read_regions(TableReader& body);

/// Looks by the names of body and skin.
using Looks = std::map<std::pair<std::string, std::string>, render::Look>;

/// All [body.NAME]; the looks of their skins go into `looks`. A body without a skin gets one named "self".
/// `solver` decides what a body that says nothing of its method is made of, and with which steps that goes together.
std::vector<sim::Body> read_bodies(TableReader& root,
                                   const sim::SolverOptions& solver,
                                   Looks& looks);

/// Reports a body whose rest shape reaches outside the world, a box of ±1000 m, or has more domains than memory
/// could hold; and mesh files that cannot be read.
void check_extent(TableReader& table, const sim::Body& body);

/// All [[pin]], of known bodies.
std::vector<sim::Pin> read_pins(TableReader& root, const std::vector<sim::Body>& bodies);

/// All [[force]].
std::vector<sim::Force> read_forces(TableReader& root, const std::vector<sim::Body>& bodies);

/// All [[probe]].
std::vector<sim::Probe> read_probes(TableReader& root, const std::vector<sim::Body>& bodies);

/// All [[collider]]. A motion that one follows has `first_frame` at time 0.
std::vector<sim::Collider> read_colliders(TableReader& root, int first_frame, double fps);

/// [contact]
sim::Contact read_contact(TableReader table,
                          const std::vector<sim::Body>& bodies,
                          sim::Steps steps);

/// frames = "1-48"
FrameRange read_frames(TableReader& root);

/// units, [camera], [light] and [output]; the colliders become props.
void read_picture(TableReader& root,
                  const std::vector<sim::Collider>& colliders,
                  render::Options& picture);

/// output.path with the shot's name for "{shot}".
std::filesystem::path read_output_folder(TableReader& root, const std::string& shot_name);

}  // namespace shots
