#include "assets/base/error.h"
#include "assets/base/srgb.h"
#include "sim/embedding/creases.h"
#include "sim/embedding/embedding.h"
#include "sim/embedding/trilinear.h"
#include "sim/lattice/regions.h"

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace sim {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double crease_angle = 40 * pi / 180;  // [rad]

// Regions are asked for this far under the surface, where the surface itself is a region's boundary. [domain edges]
constexpr double hair = 1e-3;

// A domain deforms trilinearly, so half an edge shows all it can do. But round shapes in few domains should still look
// round, and rims that are thinner than a domain smooth.
double spacing(const assets::Source& source, double domain_size) {
    constexpr double across = 48;
    const assets::Shape* shape = std::get_if<assets::Shape>(&source.geometry);
    if (!shape || std::holds_alternative<assets::Box>(*shape))
        return domain_size / 2;
    const auto solid = make_solid(source, domain_size, domain_size);
    return std::min(domain_size / 4, (solid->max - solid->min).maxCoeff() / across);
}

/// The square root of the largest eigenvalue of C = F^T F, from the cubic's trigonometric solution.
double largest_stretch(const Mat3& F) {
    const Mat3 C = F.transpose() * F;
    const double mean = C.trace() / 3;
    const Mat3 deviator = C - mean * Mat3::Identity();
    const double size = std::sqrt(deviator.squaredNorm() / 6);
    if (!(size > 0))
        return std::sqrt(mean);
    const double cos_3_phi = std::clamp((deviator / size).determinant() / 2, -1.0, 1.0);
    return std::sqrt(mean + 2 * size * std::cos(std::acos(cos_3_phi) / 3));
}

/// The normal of a surface after F, also where F is flat or inverted: cof F n = det F F^-T n. Where F leaves no
/// direction, the rest normal.
Vec3 deformed_normal(const Mat3& F, const Vec3& rest_normal) {
    Mat3 cofactor;
    cofactor << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
    const Vec3 normal = cofactor * rest_normal;
    const double length = normal.norm();
    return length > 0 ? Vec3(normal / length) : rest_normal;
}

std::string key_of(const Body& body, const Skin& skin) {
    return "body." + body.name + ".skin." + skin.name;
}

/// Throws where every point had to be moved to be carried: the skin lies elsewhere than the body.
void require_near(const Lattice& lattice,
                  const Body& body,
                  const Skin& skin,
                  const std::vector<Vec3>& points,
                  const std::vector<Binding>& bindings) {
    for (std::size_t i = 0; i < points.size(); ++i)
        if ((carried(lattice, bindings[i], lattice.corner_rest) - points[i]).norm()
            < hair * lattice.edge)
            return;
    throw assets::Error(
        assets::ErrorKind::Input,
        fmt::format("skin \"{}\" lies outside body \"{}\", which cannot carry it: both are "
                    "placed in the same space, in metres",
                    skin.name,
                    body.name),
        key_of(body, skin));
}

}  // namespace

EmbeddedSurface::EmbeddedSurface(const Lattice& lattice, const Body& body, const Skin& skin) {
    const assets::Source& source = skin.source ? *skin.source : body.source;
    const assets::Surface surface = with_key(key_of(body, skin), [&] {
        return make_surface(source, spacing(source, lattice.edge));
    });
    CreasedMesh mesh = split_creases(surface.mesh, crease_angle);
    bindings_ = bind_points(lattice, mesh.positions);
    require_near(lattice, body, skin, mesh.positions, bindings_);

    cached_.body = body.name;
    cached_.skin = skin.name;
    cached_.triangles = std::move(mesh.triangles);
    LevelMaker maker(body);
    const RegionLayers layers(body, maker);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const int region = layers.at(mesh.positions[v] - hair * lattice.edge * mesh.normals[v]);
        cached_.rest_positions.push_back(mesh.positions[v].cast<float>());
        cached_.region_color.push_back(assets::linear_from_srgb(body.regions[region].color));
        region_.push_back(static_cast<float>(region));
    }
    rest_normals_ = std::move(mesh.normals);
}

assets::SurfaceFrame EmbeddedSurface::deformed(const Lattice& lattice,
                                               std::span<const Vec3> corners,
                                               const std::vector<char>& enriched) const {
    const std::size_t n = bindings_.size();
    assets::SurfaceFrame frame;
    frame.positions.resize(n);
    frame.normals.resize(n);
    frame.attributes["region"] = region_;
    std::vector<float>& stretch = frame.attributes["stretch"];
    stretch.resize(n);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t v) {
        const Binding& binding = bindings_[v];
        const Mat3 F = deformation_gradient(lattice, binding, corners);
        frame.positions[v] = carried(lattice, binding, corners).cast<float>();
        frame.normals[v] = deformed_normal(F, rest_normals_[v]).cast<float>();
        stretch[v] = static_cast<float>(largest_stretch(F));
    });
    if (!enriched.empty()) {
        assets::check(enriched.size() == lattice.cell.size(), "one enriched flag per domain");
        std::vector<float>& flags = frame.attributes["enriched"];
        for (const Binding& binding : bindings_)
            flags.push_back(enriched[binding.domain] ? 1 : 0);
    }
    return frame;
}

}  // namespace sim
