// What decides the picture alone: units.up, camera, light, output.
#include "shots/reading/readers.h"

namespace shots {
namespace {

Vec3 read_up(TableReader table) {
    const bool z_up = table.choice<bool>("up", {{"y", false}, {"z", true}}, {}, "y");
    table.finish();
    return z_up ? Vec3::UnitZ() : Vec3::UnitY();
}

render::Camera read_camera(TableReader table) {
    render::Camera camera;
    const bool placed = table.has("position") || table.has("look_at");
    camera.frame_bodies = table.flag("frame_bodies", !placed);
    if (camera.frame_bodies && placed)
        table.error("frame_bodies",
                    "'frame_bodies' = true places the camera: leave 'position' and 'look_at' "
                    "out, or set it to "
                    "false");
    if (!camera.frame_bodies) {
        camera.position = table.vector("position", Dimension::Length);
        camera.look_at = table.vector("look_at", Dimension::Length);
        if (table.good("position") && table.good("look_at")
            && camera.position == camera.look_at)
            table.error("look_at", "'look_at' is where the camera stands");
    }
    camera.lens =
        table.number("lens", Dimension::FocalLength, {.least = 1, .most = 10000}, camera.lens);
    camera.focus = table.optional_number("focus", Dimension::Length, positive);
    camera.f_stop = table.optional_number("f_stop", Dimension::Number, positive);
    table.finish();
    return camera;
}

std::string read_light(TableReader table) {
    enum class Rig { Studio };
    table.choice<Rig>("rig", {{"studio", Rig::Studio}}, {}, "studio");
    table.finish();
    return "studio";
}

void read_size(TableReader& table, render::Options& picture) {
    constexpr long long largest = 16384;  // pixels
    const Value* value = table.value("size");
    if (value == nullptr)
        return;
    const auto* array = std::get_if<Array>(&value->is);
    const auto side = [&](std::size_t i) {
        const auto* pixels = std::get_if<long long>(&(*array)[i].is);
        return pixels != nullptr && *pixels >= 1 && *pixels <= largest
                   ? static_cast<int>(*pixels)
                   : 0;
    };
    if (array == nullptr || array->size() != 2 || side(0) == 0 || side(1) == 0) {
        table.error("size", "'size' must be [width, height] in whole pixels from 1 to 16384");
        return;
    }
    picture.width = side(0);
    picture.height = side(1);
}

/// [output] but its path.
void read_output(TableReader table, render::Options& picture) {
    enum class Only { One };
    table.has("path");
    table.words("images", {"png"}, {"exr"}, {"png"});
    read_size(table, picture);
    table.choice<Only>("renderer", {{"pathtrace", Only::One}}, {"raster"}, "pathtrace");
    picture.samples = table.whole("samples", 1, 1 << 20, picture.samples);
    table.choice<Only>("film", {{"mp4", Only::One}}, {}, "mp4");
    table.finish();
}

render::Prop prop_of(const sim::Collider& collider) {
    render::Prop prop;
    if (const auto* plane = std::get_if<sim::PlaneShape>(&collider.shape)) {
        prop.kind = render::Prop::Kind::Plane;
        prop.point = plane->point;
        prop.normal = plane->normal;
        return prop;
    }
    const auto& shape = std::get<assets::Shape>(collider.shape);
    if (const auto* sphere = std::get_if<assets::Sphere>(&shape)) {
        prop.kind = render::Prop::Kind::Sphere;
        prop.center = sphere->center;
        prop.radius = sphere->radius;
    } else {
        const auto& box = std::get<assets::Box>(shape);
        prop.kind = render::Prop::Kind::Box;
        prop.min = box.min;
        prop.max = box.max;
    }
    return prop;
}

}  // namespace

void read_picture(TableReader& root,
                  const std::vector<sim::Collider>& colliders,
                  render::Options& picture) {
    picture.up = read_up(root.picture_table("units"));
    picture.camera = read_camera(root.picture_table("camera"));
    picture.light_rig = read_light(root.picture_table("light"));
    read_output(root.picture_table("output"), picture);
    for (const sim::Collider& collider : colliders)
        if (!collider.is_drawn_from_cache())
            picture.props.push_back(prop_of(collider));
}

std::filesystem::path read_output_folder(TableReader& root, const std::string& shot_name) {
    constexpr std::string_view shot_word = "{shot}";
    TableReader table = root.table("output");
    std::string path = table.text("path", "out/{shot}");
    for (std::size_t at = 0; (at = path.find(shot_word, at)) != std::string::npos;
         at += shot_name.size())
        path.replace(at, shot_word.size(), shot_name);
    if (path.empty() || path.find_first_of("{}") != std::string::npos)
        table.error("path",
                    "'path' must be a folder, in which {shot} stands for the shot's name");
    return path;
}

}  // namespace shots
