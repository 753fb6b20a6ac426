#include "assets/base/error.h"
#include "assets/mesh/import.h"
#include "shots/reading/readers.h"

#include <Eigen/Geometry>

#include <fmt/format.h>

namespace shots {
namespace {

using Bounds = Eigen::AlignedBox3d;

constexpr double world = 1000;               // half the edge of the world [m]
constexpr double most_domains = 50'000'000;  // about 40 GB

Bounds bounds_of(const Vec3& center, const Vec3& half) {
    return {center - half, center + half};
}

Bounds local_bounds(const assets::Box& box) {
    return {box.min, box.max};
}

Bounds local_bounds(const assets::Sphere& sphere) {
    return bounds_of(sphere.center, Vec3::Constant(sphere.radius));
}

/// Half the extent along each axis of a disk of radius r across the direction n: r sqrt(1 - n_i²).
Vec3 disk_half_extent(const Vec3& direction, double radius) {
    const Vec3 n = direction.normalized();
    return radius * (1 - n.array().square()).max(0).sqrt();
}

Bounds local_bounds(const assets::Cylinder& rod) {
    const Vec3 half = disk_half_extent(rod.to - rod.from, rod.radius);
    return bounds_of(rod.from, half).merged(bounds_of(rod.to, half));
}

Bounds local_bounds(const assets::Capsule& rod) {
    const Vec3 half = Vec3::Constant(rod.radius);
    return bounds_of(rod.from, half).merged(bounds_of(rod.to, half));
}

Bounds local_bounds(const assets::Torus& torus) {
    return bounds_of(torus.center,
                     disk_half_extent(torus.axis, torus.major) + Vec3::Constant(torus.minor));
}

Bounds local_bounds(const assets::Shape& shape) {
    return std::visit([](const auto& kind) { return local_bounds(kind); }, shape);
}

Bounds local_bounds(const assets::MeshFile& file) {
    Bounds bounds;
    for (const Vec3& position : assets::import_mesh(file.path).mesh.positions)
        bounds.extend(position);
    return bounds;
}

/// Bounds of the moved bounds: exact without a rotation, never too small.
Bounds moved(const Bounds& bounds, const assets::Transform& transform) {
    Bounds result;
    for (int corner = 0; corner < 8; ++corner)
        result.extend(
            assets::apply(transform, bounds.corner(static_cast<Bounds::CornerType>(corner))));
    return result;
}

}  // namespace

void check_extent(TableReader& table, const sim::Body& body) {
    const auto* mesh = std::get_if<assets::MeshFile>(&body.source.geometry);
    if (!table.good("domain_size") || (mesh != nullptr && !table.good("mesh")))
        return;  // reported already
    const std::string word = mesh != nullptr ? "mesh" : "shape";
    try {
        const Bounds local = std::visit([](const auto& kind) { return local_bounds(kind); },
                                        body.source.geometry);
        const Bounds bounds = moved(local, body.source.transform);
        if (bounds.min().minCoeff() < -world || bounds.max().maxCoeff() > world) {
            table.error(
                word,
                fmt::format(
                    "body '{}' reaches outside the world: it spans ({:.4g}, {:.4g}, {:.4g}) to "
                    "({:.4g}, {:.4g}, {:.4g}) m, the world is a box of ±{} m; check units and "
                    "transform",
                    body.name,
                    bounds.min().x(),
                    bounds.min().y(),
                    bounds.min().z(),
                    bounds.max().x(),
                    bounds.max().y(),
                    bounds.max().z(),
                    world));
            return;
        }
        const double n_domains = (bounds.sizes() / body.domain_size).array().max(1).prod();
        if (n_domains > most_domains)
            table.error(
                "domain_size",
                fmt::format(
                    "'domain_size' {} m cuts body '{}' into up to {:.3g} domains; the limit is "
                    "{:.3g}",
                    body.domain_size,
                    body.name,
                    n_domains,
                    most_domains));
    } catch (const assets::Error& error) {
        table.error(word, error.what());
    }
}

}  // namespace shots
