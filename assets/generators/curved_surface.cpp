#include "assets/base/error.h"
#include "assets/generators/cell_vertex.h"
#include "assets/generators/procedural_surface.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace assets {

namespace {

constexpr float band = 3;  // of the level set [voxels]

/// The level set of a shape; index (i,j,k) lies at low + spacing (i,j,k).
openvdb::FloatGrid::Ptr level_set(const Shape& shape,
                                  const Vec3& low,
                                  const std::array<int, 3>& n,
                                  double spacing) {
    auto grid = openvdb::FloatGrid::create(band);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);  // decides how faces are turned

    struct Voxel {
        openvdb::Coord at;
        float distance = 0;
    };

    std::vector<std::vector<Voxel>> layers(n[2]);
    tbb::parallel_for(0, n[2], [&](int k) {
        for (int j = 0; j < n[1]; ++j)
            for (int i = 0; i < n[0];) {
                const double distance =
                    signed_distance(shape, low + spacing * Vec3(i, j, k)) / spacing;
                if (std::abs(distance) < band)
                    layers[k].push_back(
                        {openvdb::Coord(i, j, k), static_cast<float>(distance)});
                i += std::max(
                    1, static_cast<int>(std::abs(distance) - band));  // no surface is nearer
            }
    });
    auto voxels = grid->getAccessor();
    for (const std::vector<Voxel>& layer : layers)
        for (const auto& [at, distance] : layer)
            voxels.setValue(at, distance);
    openvdb::tools::signedFloodFill(grid->tree());
    return grid;
}

/// A quad of the level set's mesh, clockwise, as two triangles, counter-clockwise, cut along the given diagonal.
void add_quad(const std::array<int, 4>& quad,
              bool cut_first_diagonal,
              std::vector<std::array<int, 3>>& triangles) {
    const auto [a, b, c, d] = quad;
    if (cut_first_diagonal) {
        triangles.push_back({a, c, b});
        triangles.push_back({a, d, c});
    } else {
        triangles.push_back({a, d, b});
        triangles.push_back({b, d, c});
    }
}

/// How far outside the bounds the voxels begin along an axis that the shape extends over, in voxels: enough for the
/// band, and such that both ends fall at least a quarter of a voxel off the planes of voxel centres. Distances of
/// exactly 0 there would make triangles without area.
double margin_of(double extent) {
    const double remainder = extent - std::floor(extent);
    return std::ceil(band) + (remainder < 0.5 ? 1 - remainder : 2 - remainder) / 2;
}

}  // namespace

TriangleMesh curved_surface(const Shape& shape, double spacing) {
    Vec3 low;
    std::array<int, 3> n;
    for (int axis = 0; axis < 3; ++axis) {
        const double max = support(shape, Vec3::Unit(axis)),
                     min = -support(shape, -Vec3::Unit(axis));
        const double extent = (max - min) / spacing;
        check(extent < 1e5, "a shape is meshed with fewer than 1e5 voxels an axis");
        low[axis] = min - margin_of(extent) * spacing;
        n[axis] = static_cast<int>(std::ceil(extent + 2 * margin_of(extent))) + 1;
    }
    openvdb::initialize();
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*level_set(shape, low, n, spacing), points, quads);

    TriangleMesh mesh;
    mesh.positions.resize(points.size());
    std::vector<char> is_sharp(points.size(), false);
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t v) {
        const Vec3 voxels(points[v].x(), points[v].y(), points[v].z()),
            cell = voxels.array().floor();
        const CellVertex found =
            cell_vertex(shape, low + spacing * cell, spacing, low + spacing * voxels);
        mesh.positions[v] = found.position;
        is_sharp[v] = found.is_sharp;
    });
    for (const openvdb::Vec4I& q : quads) {
        const std::array<int, 4> quad{static_cast<int>(q[0]),
                                      static_cast<int>(q[1]),
                                      static_cast<int>(q[2]),
                                      static_cast<int>(q[3])};
        const auto diagonal = [&](int i) {
            return is_sharp[quad[i]] && is_sharp[quad[i + 2]]
                       ? 0.0
                       : (mesh.positions[quad[i]] - mesh.positions[quad[i + 2]]).norm();
        };
        add_quad(quad, diagonal(0) <= diagonal(1), mesh.triangles);
    }
    return mesh;
}

}  // namespace assets
