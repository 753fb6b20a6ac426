#include "assets/generators/point_surface.h"

#include "assets/base/error.h"
#include "assets/generators/point_cells.h"
#include "assets/generators/vdb_file.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace assets {

namespace {

using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;
using Sampler = openvdb::tools::GridSampler<FloatGrid, openvdb::tools::BoxSampler>;

// All lengths in here are in voxels, of which two make a spacing.
constexpr double spacing = 2;
// Of the kernel: irregularities of a spacing are smoothed away.
constexpr double reach = 2 * spacing;

// So that a flat side lies half a spacing outside of its outermost points, within a few hundredths in clouds in cubic
// order, turned or not, and without order. By chance a lone point has its volume, too: 4/3 π 0.62³ = 1.
constexpr double radius = 0.62 * spacing;

// From a distance of points that leaves no gaps in a cloud without order; in cubic order, gaps are 0.87 spacings deep.
constexpr double closing = 1.1 * spacing;

constexpr float outside = 2;  // value where no point is near; less than reach - radius
constexpr float band = 1;     // of the file's level set, to each side; less than radius

/// Sums over the points around a voxel.
struct Sums {
    double weight = 0;
    Vec3 offset = Vec3::Zero();  // from the voxel
    double least_squared = std::numeric_limits<double>::infinity();

    /// Requires a point within reach.
    void add(const Vec3& to_point) {
        const double d_squared = to_point.squaredNorm();
        const double share = 1 - d_squared / (reach * reach), w = share * share * share;
        weight += w;
        offset += w * to_point;
        least_squared = std::min(least_squared, d_squared);
    }

    float value() const {
        if (!(weight > 0))
            return outside;
        const double skin = offset.norm() / weight - radius;
        return std::min(static_cast<float>(std::max(skin, std::sqrt(least_squared) - closing)),
                        outside);
    }
};

/// Every voxel of a leaf of the tree from all points that reach it: no two threads write to the same.
void fill(Leaf& leaf, const PointCells& cells) {
    constexpr int n = Leaf::DIM;
    std::array<Sums, Leaf::SIZE> sums;
    const auto within = [](double x, double half_width) {
        return std::pair(std::max(static_cast<int>(std::ceil(x - half_width)), 0),
                         std::min(static_cast<int>(std::floor(x + half_width)), n - 1));
    };
    const Vec3 origin(leaf.origin().x(), leaf.origin().y(), leaf.origin().z());
    const Vec3 low = origin - Vec3::Constant(reach),
               high = origin + Vec3::Constant(n - 1 + reach);
    cells.in_box(low, high, [&](int p) {
        const Vec3 x = cells.points()[p] - origin;
        const auto [i_first, i_last] = within(x[0], reach);
        const auto [j_first, j_last] = within(x[1], reach);
        for (int i = i_first; i <= i_last; ++i)
            for (int j = j_first; j <= j_last; ++j) {
                const double left =
                    reach * reach - (x[0] - i) * (x[0] - i) - (x[1] - j) * (x[1] - j);
                if (!(left > 0))
                    continue;
                const auto [k_first, k_last] = within(x[2], std::sqrt(left));
                for (int k = k_first; k <= k_last; ++k)
                    sums[(i * n + j) * n + k].add(x - Vec3(i, j, k));
            }
    });
    for (int voxel = 0; voxel < n * n * n; ++voxel)
        leaf.setValueOn(voxel, sums[voxel].value());
}

/// φ on all leaves of the tree that a point reaches.
FloatGrid::Ptr field_of(const std::vector<Vec3>& points) {
    auto grid = openvdb::createLevelSet<FloatGrid>(1.0, outside);
    for (const Vec3& x : points) {
        const auto corner = [&](double side) {
            return openvdb::Coord(static_cast<int>(std::floor(x.x() + side)),
                                  static_cast<int>(std::floor(x.y() + side)),
                                  static_cast<int>(std::floor(x.z() + side)))
                   & ~(Leaf::DIM - 1);
        };
        const openvdb::Coord first = corner(-reach), last = corner(reach + 1);
        constexpr int step = Leaf::DIM;
        for (int i = first.x(); i <= last.x(); i += step)
            for (int j = first.y(); j <= last.y(); j += step)
                for (int k = first.z(); k <= last.z(); k += step)
                    grid->tree().touchLeaf({i, j, k});
    }
    const PointCells cells(points, reach);
    std::vector<Leaf*> leaves;
    grid->tree().getNodes(leaves);
    tbb::parallel_for(
        std::size_t{0}, leaves.size(), [&](std::size_t i) { fill(*leaves[i], cells); });
    return grid;
}

void add_quad(const openvdb::Vec4I& quad, PointSurface& surface) {
    // OpenVDB's faces are clockwise from outside. The shorter diagonal makes the better triangles.
    const std::array<int, 4> v{int(quad[3]), int(quad[2]), int(quad[1]), int(quad[0])};
    const std::vector<Vec3f>& x = surface.positions;
    if ((x[v[0]] - x[v[2]]).squaredNorm() <= (x[v[1]] - x[v[3]]).squaredNorm()) {
        surface.triangles.push_back({v[0], v[1], v[2]});
        surface.triangles.push_back({v[0], v[2], v[3]});
    } else {
        surface.triangles.push_back({v[0], v[1], v[3]});
        surface.triangles.push_back({v[1], v[2], v[3]});
    }
}

/// Central differences over two voxels, so that normals do not jump between voxels; any direction where those cancel.
Vec3f outwards(const Sampler& field, const openvdb::Vec3s& x) {
    Vec3f gradient;
    for (int axis = 0; axis < 3; ++axis) {
        openvdb::Vec3d low(x), high(x);
        low[axis] -= 1;
        high[axis] += 1;
        gradient[axis] = field.isSample(high) - field.isSample(low);
    }
    const float length = gradient.norm();
    return length > 0 ? Vec3f(gradient / length) : Vec3f(Vec3f::UnitZ());
}

PointSurface triangles_of(const FloatGrid& grid) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(grid, points, quads);
    PointSurface surface;
    surface.normals.resize(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t v) {
        surface.normals[v] = outwards(Sampler(grid.constTree(), grid.transform()), points[v]);
    });
    for (const openvdb::Vec3s& x : points)
        surface.positions.emplace_back(x.x(), x.y(), x.z());
    for (const openvdb::Vec4I& quad : quads)
        add_quad(quad, surface);
    return surface;
}

/// Makes a field a narrow band in metres: values off the band are not stored.
void finish(FloatGrid& grid, double voxel) {
    const float half_width = static_cast<float>(band * voxel);
    std::vector<Leaf*> leaves;
    grid.tree().getNodes(leaves);
    for (Leaf* leaf : leaves)
        for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
            const auto value = static_cast<float>(leaf->getValue(i) * voxel);
            leaf->setValueOnly(i, std::clamp(value, -half_width, half_width));
            leaf->setActiveState(i, std::abs(value) < half_width);
        }
    grid.tree().root().setBackground(half_width, true);
    openvdb::tools::pruneLevelSet(grid.tree());
    grid.setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    grid.setName("surface");
}

}  // namespace

PointSurface point_surface(const std::vector<Vec3>& points, double spacing_in_metres) {
    check(spacing_in_metres > 0, "the spacing of points is positive");
    openvdb::initialize();
    const double voxel = spacing_in_metres / spacing;
    std::vector<Vec3> in_voxels;
    for (const Vec3& x : points) {
        check(x.allFinite(), "positions of points are finite");
        in_voxels.push_back(x / voxel);
    }
    const FloatGrid::Ptr field = field_of(in_voxels);
    PointSurface surface = triangles_of(*field);
    for (Vec3f& x : surface.positions)
        x = (x.cast<double>() * voxel).cast<float>();
    finish(*field, voxel);
    surface.vdb = vdb_file(field);
    return surface;
}

}  // namespace assets
