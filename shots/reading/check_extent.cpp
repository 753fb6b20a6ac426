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

Bounds local_bounds(const assets::Shape& shape) {
    Bounds bounds;
    for (int axis = 0; axis < 3; ++axis) {
        bounds.max()[axis] = assets::support(shape, Vec3::Unit(axis));
        bounds.min()[axis] = -assets::support(shape, -Vec3::Unit(axis));
    }
    return bounds;
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
