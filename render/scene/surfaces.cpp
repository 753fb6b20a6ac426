#include "render/scene/surfaces.h"

#include "assets/base/error.h"
#include "render/image/view_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace render {

namespace {

// The rest of a clear body's opacity lies in its inside.
constexpr float skin_per_opacity = 0.5f;
// Optical depth across the body, in units of -ln(colour).
constexpr float depth_per_opacity = 2.0f;

Vec3f mean(const std::vector<Vec3f>& values) {
    Vec3f sum = Vec3f::Zero();
    for (const Vec3f& value : values)
        sum += value;
    return values.empty() ? sum : Vec3f(sum / float(values.size()));
}

float mean_edge_of_bounds(const std::vector<Vec3f>& points) {
    Vec3f low = points[0], high = points[0];
    for (const Vec3f& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    return (high - low).mean();
}

// The inside takes the colour out of white light over about the body's size.
Material material_of(const assets::CachedSurface& surface, const Look& look) {
    Material material;
    material.coated = look.coated;
    material.roughness = look.roughness;
    if (look.opacity >= 1)
        return material;
    const Vec3f tint = look.color_by == ColorBy::Region ? mean(surface.region_color)
                                                        : linear_from_srgb(look.color);
    const float size = mean_edge_of_bounds(surface.rest_positions);
    material.opacity = skin_per_opacity * look.opacity;
    if (size > 0)
        material.absorption = -tint.array().max(0.02f).min(1.0f).log()
                              * (depth_per_opacity * look.opacity / size);
    return material;
}

}  // namespace

Vec3f stretch_color(float stretch) {
    static constexpr std::array<std::array<int, 3>, 9> knots{{{68, 1, 84},
                                                              {71, 45, 123},
                                                              {59, 82, 139},
                                                              {44, 114, 142},
                                                              {33, 145, 140},
                                                              {40, 174, 128},
                                                              {94, 201, 98},
                                                              {173, 220, 48},
                                                              {253, 231, 37}}};
    const float at = std::clamp(stretch - 1, 0.0f, 1.0f) * float(knots.size() - 1);
    const std::size_t i = std::min(std::size_t(at), knots.size() - 2);
    const auto color = [](const std::array<int, 3>& rgb) {
        return Vec3f(float(rgb[0]), float(rgb[1]), float(rgb[2]));
    };
    const float t = at - float(i);
    return linear_from_srgb(Vec3f(((1 - t) * color(knots[i]) + t * color(knots[i + 1])) / 255));
}

Surface::Surface(const assets::CachedSurface& cached, const Look& look)
    : cached_(cached),
      look_(look),
      topology_(split_creases(cached.triangles, cached.rest_positions)) {
    if (cached.varying && look.opacity < 1)
        throw assets::Error(
            assets::ErrorKind::Input,
            fmt::format(
                "body \"{}\" is made of points, which cannot be drawn clear: its opacity "
                "is {}, 1 is allowed",
                cached.body,
                look.opacity),
            "body." + cached.body + ".skin");
    const bool never_drawn = cached.rest_positions.empty() && !cached.varying;
    material_ = never_drawn ? Material{} : material_of(cached, look);
}

std::vector<Vec3f> Surface::colors(const assets::SurfaceFrame& frame) const {
    const std::size_t n = frame.positions.size();
    std::vector<Vec3f> result;
    if (look_.color_by == ColorBy::Look)
        result.assign(n, linear_from_srgb(look_.color));
    if (look_.color_by == ColorBy::Region) {
        result = cached_.varying ? frame.region_color : cached_.region_color;
        assets::check(result.size() == n, "a surface has region colours");
    }
    if (look_.color_by == ColorBy::Stretch) {
        const auto stretch = frame.attributes.find("stretch");
        assets::check(stretch != frame.attributes.end() && stretch->second.size() == n,
                      "a frame has stretches");
        for (const float value : stretch->second)
            result.push_back(stretch_color(value));
    }
    for (Vec3f& color : result)
        color = color.cwiseMax(0.0f).cwiseMin(1.0f);
    return result;
}

// Smooth all over, with the frame's normals: no edge of a heap of points is meant to be sharp.
Mesh Surface::varying_at(const assets::SurfaceFrame& frame) const {
    assets::check(frame.normals.size() == frame.positions.size(), "a frame has normals");
    return {frame.triangles, frame.positions, frame.normals, colors(frame), material_};
}

Mesh Surface::at(const assets::SurfaceFrame& frame) const {
    if (cached_.varying)
        return varying_at(frame);
    const std::size_t n = cached_.rest_positions.size();
    assets::check(frame.positions.size() == n && frame.normals.size() == n,
                  "a frame fits its surface");
    Mesh mesh;
    mesh.material = material_;
    mesh.triangles = topology_.triangles;
    mesh.normals = split_normals(topology_, frame.positions, frame.normals);
    const std::vector<Vec3f> vertex_colors = colors(frame);
    for (const int vertex : topology_.source) {
        mesh.positions.push_back(frame.positions[vertex]);
        mesh.colors.push_back(vertex_colors[vertex]);
    }
    return mesh;
}

}  // namespace render
