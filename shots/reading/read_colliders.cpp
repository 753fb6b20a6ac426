// What bodies touch: colliders and each other.
#include "shots/reading/motion_file.h"
#include "shots/reading/readers.h"

#include <algorithm>
#include <fmt/format.h>

namespace shots {
namespace {

/// A coefficient, "stick" or "slip".
sim::Friction read_friction(TableReader& table) {
    const Value* value = table.value("friction");
    if (value == nullptr || !std::holds_alternative<std::string>(value->is))
        return {false, table.number("friction", Dimension::Number, not_negative, 0.0)};
    const bool stick =
        table.choice<bool>("friction", {{"stick", true}, {"slip", false}}, {}, "slip");
    return {stick, 0};
}

sim::PlaneShape read_plane(TableReader table) {
    const sim::PlaneShape plane{table.vector("point", Dimension::Length),
                                table.direction("normal")};
    table.finish();
    return plane;
}

std::vector<sim::ColliderKey> read_keys(TableReader& collider) {
    std::vector<sim::ColliderKey> keys;
    for (TableReader& table : collider.tables("keys")) {
        sim::ColliderKey key;
        key.time = table.number("time", Dimension::Time, not_negative);
        key.translate = table.vector("translate", Dimension::Length, Vec3(Vec3::Zero()));
        key.rotate = table.vector("rotate", Dimension::Angle, Vec3(Vec3::Zero()));
        if (!keys.empty() && key.time <= keys.back().time)
            table.error("time",
                        "the times of keys ascend: this one is not after the one before");
        table.finish();
        keys.push_back(key);
    }
    return keys;
}

/// The keys of a baked motion; what is wrong in its file is told at the word that names it.
std::vector<sim::ColliderKey> read_follow(TableReader& collider, int first_frame, double fps) {
    constexpr std::size_t most_shown = 10;
    const std::filesystem::path file = collider.file("follow");
    if (!collider.good("follow"))
        return {};
    std::vector<std::string> mistakes;
    std::vector<sim::ColliderKey> keys = read_motion(file, first_frame, fps, mistakes);
    for (std::size_t k = 0; k < std::min(mistakes.size(), most_shown); ++k)
        collider.error("follow", fmt::format("{}:{}", file.string(), mistakes[k]));
    if (mistakes.size() > most_shown)
        collider.error(
            "follow",
            fmt::format("{}: {} more mistakes", file.string(), mistakes.size() - most_shown));
    return keys;
}

void read_motion_of(TableReader& table, int first_frame, double fps, sim::Collider& collider) {
    collider.keys = read_keys(table);
    if (!table.has("follow"))
        return;
    if (!collider.keys.empty())
        table.error("follow", "'keys' and 'follow' exclude each other: keep one");
    collider.keys = read_follow(table, first_frame, fps);
    collider.pivot = Vec3::Zero();
}

sim::Collider read_collider(TableReader& table, int first_frame, double fps) {
    sim::Collider collider;
    std::vector<std::string> words = shape_words();
    words.insert(words.end(), {"plane", "mesh"});
    const std::string word = table.one_of(words);
    if (word == "plane") {
        collider.shape = read_plane(table.table("plane"));
    } else if (word == "mesh") {
        collider.shape = assets::MeshFile{table.file(word)};
    } else if (!word.empty()) {
        collider.shape = read_shape(table, word);
    }
    collider.friction = read_friction(table);
    read_motion_of(table, first_frame, fps, collider);
    if (word == "plane" && !collider.keys.empty())
        table.error(table.has("keys") ? "keys" : "follow",
                    "a plane stands still: use a box where a wall moves");
    table.finish();
    return collider;
}

}  // namespace

std::vector<sim::Collider> read_colliders(TableReader& root, int first_frame, double fps) {
    std::vector<sim::Collider> colliders;
    for (TableReader& table : root.tables("collider"))
        colliders.push_back(read_collider(table, first_frame, fps));
    return colliders;
}

sim::Contact read_contact(TableReader table,
                          const std::vector<sim::Body>& bodies,
                          sim::Steps steps) {
    using Mode = sim::Contact::Mode;
    sim::Contact contact;
    contact.mode = table.choice<Mode>(
        "mode", {{"surface", Mode::Surface}, {"grid", Mode::Grid}}, {}, "surface");
    if (contact.mode == Mode::Grid && steps == sim::Steps::Static)
        table.error("mode",
                    "'mode' = 'grid' meets velocities, and 'steps' = 'static' has none: use "
                    "'surface'");
    contact.friction = read_friction(table);
    for (TableReader& pair : table.tables("pair")) {
        contact.pairs.push_back({{pair.reference("body", "body", names_of(bodies)),
                                  pair.reference("with", "body", names_of(bodies))},
                                 read_friction(pair)});
        pair.finish();
    }
    table.finish();
    return contact;
}

}  // namespace shots
