#include "assets/generators/point_surface.h"
#include "assets/generators/point_values.h"
#include "assets/mesh/triangle_mesh.h"
#include "tests/support/random_fields.h"
#include "tests/support/threads.h"
#include "tests/unit/assets/frames/cache_fixture.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

using namespace assets;

namespace {

constexpr double spacing = 0.01;
constexpr int n_edge = 14;  // points along the edge of a block

/// n³ points in cubic order, each off its place by up to `disorder` / 2 spacings along each axis.
std::vector<Vec3> block(int n, double disorder = 0, const Vec3& low = Vec3::Zero()) {
    tests::Random random(5);
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k)
                points.push_back(
                    low
                    + spacing * (Vec3(i, j, k) + tests::random_vector(random, disorder / 2)));
    return points;
}

std::vector<Vec3> turned(std::vector<Vec3> points) {
    const Mat3 R = Eigen::AngleAxisd(0.6, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (Vec3& x : points)
        x = R * x;
    return points;
}

std::vector<Vec3> joined(std::vector<Vec3> a, const std::vector<Vec3>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

double volume(const PointSurface& surface) {
    TriangleMesh mesh;
    for (const Vec3f& x : surface.positions)
        mesh.positions.push_back(x.cast<double>());
    mesh.triangles = surface.triangles;
    return signed_volume(mesh);
}

/// Edges that the triangles around them do not run through equally often in both directions.
int n_open_edges(const PointSurface& surface) {
    std::map<std::pair<int, int>, int> balance;
    for (const auto& triangle : surface.triangles)
        for (int k = 0; k < 3; ++k) {
            const int a = triangle[k], b = triangle[(k + 1) % 3];
            balance[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    return static_cast<int>(std::count_if(
        balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; }));
}

int n_pieces(const PointSurface& surface) {
    std::vector<int> parent(surface.positions.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int v) {
        while (parent[v] != v)
            v = parent[v] = parent[parent[v]];
        return v;
    };
    auto n = static_cast<int>(parent.size());
    for (const auto& triangle : surface.triangles)
        for (const int corner : {1, 2}) {
            const int a = root(triangle[0]), b = root(triangle[corner]);
            n -= a != b;
            parent[a] = b;
        }
    return n;
}

}  // namespace

TEST_CASE(
    "the surface of a dense block encloses the volume of its points, in any order of theirs") {
    const std::vector<Vec3> points = GENERATE(
        block(n_edge), turned(block(n_edge)), block(n_edge, 0.5), turned(block(n_edge, 1)));
    const double expected = static_cast<double>(points.size()) * std::pow(spacing, 3);
    // Six sides off by a tenth of a spacing would make 6 * 0.1 / 14.
    CHECK(volume(point_surface(points, spacing)) == Approx(expected).epsilon(0.043));
}

TEST_CASE("a flat side lies half a spacing outside of its points, and is flat") {
    const PointSurface surface = point_surface(block(n_edge), spacing);
    const double top = (n_edge - 1) * spacing;
    int n_looked_at = 0;
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
        const Vec3 x = surface.positions[v].cast<double>();
        const auto inner = [&](double along) { return along > top / 3 && along < 2 * top / 3; };
        if (!inner(x.x()) || !inner(x.y()) || x.z() < top)
            continue;
        ++n_looked_at;
        CHECK(std::abs(x.z() - top - spacing / 2) < 0.1 * spacing);
        CHECK(surface.normals[v].z() > 0.99f);
    }
    CHECK(n_looked_at > 50);
}

TEST_CASE("the surface is closed and turned outwards, its normals too") {
    const PointSurface surface =
        point_surface(joined(block(6, 1), block(1, 0, {0.2, 0, 0})), spacing);
    CHECK(n_open_edges(surface) == 0);
    CHECK(volume(surface) > 0);
    int n_against = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        const Vec3f &x = surface.positions[a], y = surface.positions[b],
                    z = surface.positions[c];
        const Vec3f area = (y - x).cross(z - x);
        n_against +=
            (surface.normals[a] + surface.normals[b] + surface.normals[c]).dot(area) < 0;
    }
    CHECK(n_against == 0);
    for (const Vec3f& normal : surface.normals)
        CHECK(normal.norm() == Approx(1).epsilon(1e-5));
}

TEST_CASE("pieces apart stay apart, narrow gaps close") {
    constexpr int n = 6;
    const auto two_blocks = [](double gap) {  // between their sides
        const double shift = (n + gap) * spacing;
        return point_surface(joined(block(n), block(n, 0, {shift, 0, 0})), spacing);
    };
    CHECK(n_pieces(two_blocks(1.6)) == 2);
    CHECK(n_pieces(two_blocks(2))
          == 2);  // the middle, where the points' mean is, lies on voxels
    CHECK(n_pieces(two_blocks(3)) == 2);
    CHECK(n_pieces(two_blocks(0.5)) == 1);
}

TEST_CASE("a point alone is a small ball wherever it lies between the voxels") {
    tests::Random random(8);
    for (int repeat = 0; repeat < 20; ++repeat) {
        const Vec3 point = tests::random_vector(random, 0.1);
        const PointSurface surface = point_surface({point}, spacing);
        REQUIRE(n_pieces(surface) == 1);
        CHECK(n_open_edges(surface) == 0);
        for (const Vec3f& x : surface.positions) {
            const double radius = (x.cast<double>() - point).norm() / spacing;
            CHECK((radius > 0.35 && radius < 0.7));  // a ball of 0.62, cut at voxels of 0.5
        }
    }
}

TEST_CASE(
    "the surface and its file are the same for any number of threads, and the next time") {
    const std::vector<Vec3> points = block(12, 1);
    const auto surface_on = [&](int n_threads) {
        return tests::on_threads(n_threads, [&] { return point_surface(points, spacing); });
    };
    const PointSurface one = surface_on(1);
    for (int repeat = 0; repeat < 3; ++repeat) {
        const PointSurface two = surface_on(2);
        CHECK(one.positions == two.positions);
        CHECK(one.normals == two.normals);
        CHECK(one.triangles == two.triangles);
        CHECK(one.vdb == two.vdb);
    }
}

TEST_CASE("no points have no surface, points nowhere and no spacing are refused") {
    const PointSurface none = point_surface({}, spacing);
    CHECK(none.positions.empty());
    CHECK(none.triangles.empty());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(point_surface({{0, nan, 0}}, spacing), std::logic_error);
    CHECK_THROWS_AS(point_surface({{0, 1e9, 0}}, spacing), std::logic_error);
    CHECK_THROWS_AS(point_surface({{0, 0, 0}}, 0), std::logic_error);
}

TEST_CASE("OpenVDB reads the file back: a level set in metres whose zero is the surface") {
    const tests::TemporaryFolder folder;
    const auto path = folder.path() / "block.0001.vdb";
    const PointSurface surface = point_surface(block(8), spacing);
    tests::write_file(path, surface.vdb);

    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.open(false);  // all at once
    REQUIRE(file.getGrids()->size() == 1);
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
    CHECK(grid->getGridClass() == openvdb::GRID_LEVEL_SET);
    CHECK(grid->voxelSize().x() == Approx(spacing / 2));
    CHECK(grid->background() == Approx(spacing / 2));
    const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> sampler(
        *grid);
    const auto value = [&](const Vec3& x) { return sampler.wsSample({x.x(), x.y(), x.z()}); };
    CHECK(value(Vec3::Constant(4 * spacing)) < -0.2 * spacing);
    CHECK(value(Vec3::Constant(30 * spacing)) == Approx(spacing / 2));
    // A vertex is the mean of a voxel's crossings, the file cut off at a voxel to each side: zero but for some curvature.
    int n_off = 0;
    for (const Vec3f& x : surface.positions)
        n_off += std::abs(value(x.cast<double>())) > 0.25 * spacing / 2;
    CHECK(n_off == 0);
}

TEST_CASE("values of points reach places near them as means and from the nearest point") {
    const std::vector<Vec3> points = block(8, 0.3);
    tests::Random random(2);
    std::vector<Vec3f> places;
    for (int i = 0; i < 50; ++i)
        places.push_back(
            (spacing * (Vec3::Constant(3.5) + tests::random_vector(random, 1))).cast<float>());
    const PointValues values(points, spacing, places);

    std::vector<float> xs;
    std::vector<Vec3f> colors(points.size(), Vec3f(0.1f, 0.2f, 0.3f));
    for (const Vec3& x : points)
        xs.push_back(static_cast<float>(x.x()));
    const std::vector<float> mean = values.mean(xs), nearest = values.nearest(xs);
    for (std::size_t i = 0; i < places.size(); ++i) {
        CHECK((values.mean(colors)[i] - colors[0]).norm() < 1e-6f);
        CHECK(std::abs(mean[i] - places[i].x()) < 0.15 * spacing);  // in the dense middle
        const auto distance = [&](const Vec3& x) {
            return (x - places[i].cast<double>()).norm();
        };
        const auto least =
            std::min_element(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) {
                return distance(a) < distance(b);
            });
        CHECK(nearest[i] == xs[static_cast<std::size_t>(least - points.begin())]);
    }
    CHECK_THROWS_AS(PointValues(points, spacing, {Vec3f(1, 1, 1)}), std::logic_error);
}
