#include "assets/frames/encoding.h"

#include "assets/base/error.h"
#include "assets/frames/byte_stream.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace assets {
namespace {

static_assert(sizeof(Vec3f) == 3 * sizeof(float), "vectors lie in files without gaps");

bool all_finite(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool all_finite(const std::vector<Vec3f>& values) {
    return std::all_of(
        values.begin(), values.end(), [](const Vec3f& v) { return v.allFinite(); });
}

void check_triangles(const std::vector<std::array<int, 3>>& triangles, std::size_t n_vertices) {
    for (const auto& triangle : triangles)
        for (const int v : triangle)
            check(v >= 0 && static_cast<std::size_t>(v) < n_vertices,
                  "triangles name vertices that exist");
}

void check_surface(const CachedSurface& surface) {
    const std::size_t n = surface.rest_positions.size();
    check(!surface.varying || n == 0, "a varying surface has its vertices in the frames");
    check(surface.region_color.size() == n, "a surface has as many colours as vertices");
    check(all_finite(surface.rest_positions), "rest positions are finite");
    check(all_finite(surface.region_color), "colours are finite");
    check_triangles(surface.triangles, n);
}

void check_surface(const SurfaceFrame& surface, VertexCount fixed) {
    const std::size_t n_vertices = fixed.value_or(surface.positions.size());
    check(surface.positions.size() == n_vertices, "a frame has the vertices of its surface");
    check(surface.normals.size() == n_vertices, "a frame has a normal for each vertex");
    check(!fixed || surface.triangles.empty(),
          "a surface that does not vary keeps its triangles");
    check(surface.region_color.size() == (fixed ? 0 : n_vertices),
          "a frame has a colour for each vertex of a varying surface, and of no other");
    check(all_finite(surface.region_color), "colours are finite");
    check_triangles(surface.triangles, n_vertices);
    check(all_finite(surface.positions), "positions are finite");
    check(all_finite(surface.normals), "normals are finite");
    for (const auto& [name, values] : surface.attributes) {
        check(values.size() == n_vertices, "an attribute has a value for each vertex");
        check(all_finite(values), "attributes are finite");
    }
}

/// Smallest box around all surfaces; a point at the origin where there are no vertices.
void set_bounds(FileHeader& header, const std::vector<SurfaceFrame>& surfaces) {
    bool any = false;
    Vec3f low = Vec3f::Zero(), high = Vec3f::Zero();
    for (const SurfaceFrame& surface : surfaces)
        for (const Vec3f& x : surface.positions) {
            low = any ? low.cwiseMin(x).eval() : x;
            high = any ? high.cwiseMax(x).eval() : x;
            any = true;
        }
    header.low = {low.x(), low.y(), low.z()};
    header.high = {high.x(), high.y(), high.z()};
}

void put_surface_frame(ByteWriter& bytes, const SurfaceFrame& surface, bool varies) {
    bytes.put_count(varies ? 1 : 0);
    bytes.put_count(surface.positions.size());
    bytes.put_count(surface.attributes.size());
    bytes.put_elements(surface.positions);
    bytes.put_elements(surface.normals);
    for (const auto& [name, values] : surface.attributes) {
        bytes.put_text(name);
        bytes.put_elements(values);
    }
    if (!varies)
        return;
    bytes.put_count(surface.triangles.size());
    bytes.put_elements(surface.triangles);
    bytes.put_elements(surface.region_color);
}

SurfaceFrame decode_surface_frame(ByteReader& bytes) {
    SurfaceFrame surface;
    const bool varies = bytes.count() != 0;
    const std::size_t n_vertices = bytes.count();
    const std::size_t n_attributes = bytes.count();
    surface.positions = bytes.elements<Vec3f>(n_vertices);
    surface.normals = bytes.elements<Vec3f>(n_vertices);
    for (std::size_t i = 0; i < n_attributes; ++i) {
        const std::string name = bytes.text();
        surface.attributes[name] = bytes.elements<float>(n_vertices);
    }
    if (varies) {
        surface.triangles = bytes.elements<std::array<int, 3>>(bytes.count());
        surface.region_color = bytes.elements<Vec3f>(n_vertices);
    }
    return surface;
}

}  // namespace

std::string encode_surfaces(const std::vector<CachedSurface>& surfaces) {
    ByteWriter bytes;
    bytes.put_count(surfaces.size());
    for (const CachedSurface& surface : surfaces) {
        check_surface(surface);
        bytes.put_text(surface.body);
        bytes.put_text(surface.skin);
        bytes.put_count(surface.varying ? 1 : 0);
        bytes.put_count(surface.rest_positions.size());
        bytes.put_count(surface.triangles.size());
        bytes.put_elements(surface.rest_positions);
        bytes.put_elements(surface.region_color);
        bytes.put_elements(surface.triangles);
    }
    FileHeader header;
    header.kind = FileKind::Surfaces;
    return pack(header, bytes.take());
}

std::vector<CachedSurface> decode_surfaces(const PackedFile& file) {
    ByteReader bytes(file.content);
    const std::size_t n_surfaces = bytes.count();
    std::vector<CachedSurface> surfaces;
    for (std::size_t s = 0; s < n_surfaces; ++s) {
        CachedSurface& surface = surfaces.emplace_back();
        surface.body = bytes.text();
        surface.skin = bytes.text();
        surface.varying = bytes.count() != 0;
        const std::size_t n_vertices = bytes.count();
        const std::size_t n_triangles = bytes.count();
        surface.rest_positions = bytes.elements<Vec3f>(n_vertices);
        surface.region_color = bytes.elements<Vec3f>(n_vertices);
        surface.triangles = bytes.elements<std::array<int, 3>>(n_triangles);
    }
    return surfaces;
}

std::string encode_frame(const Frame& frame, const std::vector<VertexCount>& n_vertices) {
    check(frame.surfaces.size() == n_vertices.size(), "a frame has the surfaces of its cache");
    check(std::isfinite(frame.time), "a frame's time is finite");
    ByteWriter bytes;
    bytes.put_count(frame.surfaces.size());
    for (std::size_t s = 0; s < frame.surfaces.size(); ++s) {
        check_surface(frame.surfaces[s], n_vertices[s]);
        put_surface_frame(bytes, frame.surfaces[s], !n_vertices[s]);
    }
    FileHeader header;
    header.kind = FileKind::Frame;
    header.number = frame.number;
    header.time = frame.time;
    set_bounds(header, frame.surfaces);
    return pack(header, bytes.take());
}

Frame decode_frame(const PackedFile& file) {
    Frame frame;
    frame.number = file.header.number;
    frame.time = file.header.time;
    ByteReader bytes(file.content);
    const std::size_t n_surfaces = bytes.count();
    for (std::size_t s = 0; s < n_surfaces; ++s)
        frame.surfaces.push_back(decode_surface_frame(bytes));
    return frame;
}

std::string encode_checkpoint(int frame_number, const std::vector<std::byte>& state) {
    FileHeader header;
    header.kind = FileKind::Checkpoint;
    header.number = frame_number;
    header.word_bytes = sizeof(double);
    return pack(header, {reinterpret_cast<const char*>(state.data()), state.size()});
}

}  // namespace assets
