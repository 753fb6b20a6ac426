#include "assets/generators/mesh_solid.h"

#include "assets/base/error.h"
#include "assets/mesh/repair.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace assets {

namespace {

// A level set that lost or gained this factor of the mesh's volume has not understood it. Parts that overlap count
// twice in the mesh's volume, hence no narrower.
constexpr double most_volume_ratio = 2;

// A level set that misses the mesh's volume by more has lost thin parts; half its voxels may have them.
constexpr double volume_tolerance = 0.005;
constexpr int most_halvings = 2;

// A volume that the last halving has changed by more, and that is as far from the mesh's, is not to be trusted.
constexpr double largest_change = 0.1;
constexpr double most_voxels = 1e8;  // some 400 MB

/// Volume inside a level set whose values and voxels are in voxel units.   [voxels]
double enclosed_volume(const openvdb::FloatGrid& grid) {
    double volume = 0;
    for (auto value = grid.tree().cbeginValueAll(); value; ++value) {
        const double inside = std::clamp(0.5 - static_cast<double>(*value), 0.0, 1.0);
        volume += inside * static_cast<double>(value.getVoxelCount());
    }
    return volume;
}

Vec3 lower_bound(const TriangleMesh& mesh) {
    Vec3 low = mesh.positions.front();
    for (const Vec3& x : mesh.positions)
        low = low.cwiseMin(x);
    return low;
}

Vec3 upper_bound(const TriangleMesh& mesh) {
    Vec3 high = mesh.positions.front();
    for (const Vec3& x : mesh.positions)
        high = high.cwiseMax(x);
    return high;
}

/// In voxels from `low`, so that single precision is relative to the mesh's size wherever it lies.
openvdb::FloatGrid::ConstPtr level_set(const TriangleMesh& mesh,
                                       const Vec3& low,
                                       double voxel,
                                       double band) {
    std::vector<openvdb::Vec3s> points;
    for (const Vec3& x : mesh.positions) {
        const Vec3 at = (x - low) / voxel;
        points.emplace_back(at.x(), at.y(), at.z());
    }
    std::vector<openvdb::Vec3I> triangles;
    for (const auto& [a, b, c] : mesh.triangles)
        triangles.emplace_back(a, b, c);
    openvdb::initialize();
    const auto unit_voxels = openvdb::math::Transform::createLinearTransform(1.0);
    // Two voxels more than asked, as trilinear samples reach a voxel's diagonal further.
    const auto half_width = static_cast<float>(std::ceil(band / voxel) + 2);
    return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
        *unit_voxels, points, triangles, half_width);
}

class LevelSetSolid : public Solid {
  public:
    LevelSetSolid(const TriangleMesh& mesh, double voxel, double band)
        : voxel_(voxel),
          grid_(level_set(mesh, lower_bound(mesh), voxel, band)),
          accessor_(grid_->getConstUnsafeAccessor()) {
        min = lower_bound(mesh);
        max = upper_bound(mesh);
    }

    double signed_distance(const Vec3& x) const override {
        const Vec3 at = (x - min) / voxel_;
        return voxel_
               * openvdb::tools::BoxSampler::sample(accessor_.local(),
                                                    openvdb::Vec3d(at.x(), at.y(), at.z()));
    }

    double volume() const { return enclosed_volume(*grid_) * voxel_ * voxel_ * voxel_; }

    double voxel() const { return voxel_; }

    double n_voxels() const { return static_cast<double>(grid_->activeVoxelCount()); }

  private:
    double voxel_;
    openvdb::FloatGrid::ConstPtr grid_;

    // Neighbouring samples share the path down the tree that an accessor remembers; each thread has its own. They are
    // not registered with the tree, which does not change.
    using Accessor = openvdb::FloatGrid::ConstUnsafeAccessor;
    mutable tbb::enumerable_thread_specific<Accessor> accessor_;
};

/// A level set fine enough for the thin parts of a mesh, or not: then finer voxels would still change its volume.
struct ResolvedSolid {
    std::unique_ptr<LevelSetSolid> solid;
    bool is_resolved = true;
};

/// Halves voxels where they are too coarse for thin parts. Where finer ones change nothing, the volumes differ since
/// parts of the mesh overlap.
ResolvedSolid resolved(const TriangleMesh& mesh, double voxel, double band) {
    ResolvedSolid result{std::make_unique<LevelSetSolid>(mesh, voxel, band)};
    const double of_mesh = signed_volume(mesh);
    for (int halvings = 0; halvings < most_halvings; ++halvings) {
        const double volume = result.solid->volume();
        if (std::abs(volume - of_mesh) <= volume_tolerance * of_mesh
            || 8 * result.solid->n_voxels() > most_voxels)
            break;
        auto finer = std::make_unique<LevelSetSolid>(mesh, result.solid->voxel() / 2, band);
        const double change = std::abs(finer->volume() - volume);
        if (change <= volume_tolerance * volume)
            break;
        result = {std::move(finer), change <= largest_change * volume};
    }
    return result;
}

}  // namespace

std::unique_ptr<Solid> make_mesh_solid(const TriangleMesh& mesh,
                                       const std::filesystem::path& name,
                                       double voxel,
                                       double band) {
    check(!mesh.triangles.empty(), "the mesh of a solid has triangles");
    if (const int open = boundary_edge_count(mesh); open > 0)
        throw Error(ErrorKind::Input,
                    fmt::format("mesh \"{}\" has no inside: {} edges are open. Close it in a "
                                "modelling program, "
                                "or use its parts as skins of a shape",
                                name.string(),
                                open));
    auto [solid, is_resolved] = resolved(mesh, voxel, band);
    const double of_mesh = signed_volume(mesh), of_solid = solid->volume();
    if (!(of_mesh > 0) || of_solid > most_volume_ratio * of_mesh
        || of_mesh > most_volume_ratio * of_solid
        || (!is_resolved && std::abs(of_solid - of_mesh) > largest_change * of_mesh))
        throw Error(
            ErrorKind::Input,
            fmt::format(
                "mesh \"{}\" is no clear solid: its triangles enclose {:.3g} m^3, its inside "
                "in "
                "voxels of {:.3g} m is {:.3g} m^3 (0 open edges). Are its walls thinner than "
                "that, or some parts inside out?",
                name.string(),
                of_mesh,
                solid->voxel(),
                of_solid));
    return std::move(solid);  // a structured binding is not moved by itself
}

}  // namespace assets
