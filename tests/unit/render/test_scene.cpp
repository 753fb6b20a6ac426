#include "assets/base/error.h"
#include "render/scene/axes.h"
#include "render/scene/creases.h"
#include "render/scene/props.h"
#include "render/scene/studio.h"
#include "render/scene/surfaces.h"
#include "tests/unit/render/meshes.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <set>

using namespace render;

namespace {

// Volume enclosed by a closed mesh that is counter-clockwise from outside; negative if inside out.
double signed_volume(const Mesh& mesh) {
    double volume = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        volume += double(mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c]))) / 6;
    return volume;
}

// The unit cube with eight shared vertices, as importers make it.
const std::vector<Vec3f> cube_positions{
    {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
const std::vector<std::array<int, 3>> cube_triangles{{0, 2, 1},
                                                     {1, 2, 3},
                                                     {4, 5, 6},
                                                     {5, 7, 6},
                                                     {0, 1, 4},
                                                     {1, 5, 4},
                                                     {2, 6, 3},
                                                     {3, 6, 7},
                                                     {0, 4, 2},
                                                     {2, 4, 6},
                                                     {1, 3, 5},
                                                     {3, 7, 5}};

}  // namespace

TEST_CASE("the axes of the studio are right-handed for any up") {
    CHECK(studio_axes({0, 1, 0}).front == Vec3(0, 0, 1));
    CHECK(studio_axes({0, 0, 3}).front == Vec3(0, -1, 0));
    for (const Vec3& up : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0.3, -2, 1)}) {
        const auto [right, u, front] = studio_axes(up);
        CHECK((right.cross(u) - front).norm() < 1e-12);
        CHECK((u - up.normalized()).norm() < 1e-12);
    }
    CHECK_THROWS_AS(studio_axes(Vec3::Zero()), assets::Error);
}

TEST_CASE("a cube's vertices split into its faces, with the faces' normals when turned") {
    const SplitTopology split = split_creases(cube_triangles, cube_positions);
    CHECK(split.source.size() == 24);
    std::vector<Vec3f> turned;
    for (const Vec3f& x : cube_positions)
        turned.emplace_back(-x.y(), x.x(), x.z());
    const std::vector<Vec3f> normals =
        split_normals(split, turned, std::vector<Vec3f>(8, Vec3f::UnitX()));
    for (const auto& [a, b, c] : split.triangles) {
        const auto x = [&](int vertex) { return turned[split.source[vertex]]; };
        const Vec3f expected = (x(b) - x(a)).cross(x(c) - x(a)).normalized();
        for (const int vertex : {a, b, c})
            CHECK((normals[vertex] - expected).norm() < 1e-6f);
    }
}

TEST_CASE("a smooth surface keeps its vertices and its given normals") {
    const Mesh ball = testing::sphere(Vec3f::Zero(), 1, Vec3f::Ones(), testing::matt());
    const SplitTopology split = split_creases(ball.triangles, ball.positions);
    const std::vector<Vec3f> normals = split_normals(split, ball.positions, ball.normals);
    for (std::size_t s = 0; s < split.source.size(); ++s)
        if (std::abs(ball.normals[split.source[s]].z())
            < 0.99f)  // the poles of this mesh have triangles without area
            REQUIRE((!split.on_crease[s] && normals[s] == ball.normals[split.source[s]]));
}

TEST_CASE("props enclose their volume, seen from outside") {
    Prop prop;
    prop.kind = Prop::Kind::Sphere;
    prop.radius = 0.5;
    CHECK(signed_volume(prop_mesh(prop)) == Approx(M_PI / 6).epsilon(5e-3));
    prop.kind = Prop::Kind::Box;
    prop.min = {-1, -2, -3}, prop.max = {0, 1, 2};
    const Mesh box = prop_mesh(prop);
    CHECK(signed_volume(box) == Approx(15));
    for (const auto& [a, b, c] : box.triangles) {
        const Vec3f normal =
            (box.positions[b] - box.positions[a]).cross(box.positions[c] - box.positions[a]);
        CHECK(normal.normalized().dot(box.normals[a]) == Approx(1));
    }
}

TEST_CASE("the studio's floor touches what stands and stays clear of what moves down") {
    Options options;
    const Bounds standing{{-1, 2, -1}, {1, 4, 1}}, lower{{-1, 1, -1}, {1, 3, 1}};
    const auto height = [&](const std::vector<Bounds>& bounds) {
        return make_studio(options, bounds).floors.at(0).point.y();
    };
    CHECK(height({standing, standing}) == Approx(2).margin(0.01));
    CHECK(height({standing, lower}) < 0.9);

    Prop plane;
    plane.point = {5, -3, 0};
    plane.normal = {0, 2, 0};
    options.props = {plane};
    CHECK(height({standing, lower}) == Approx(-3));
    CHECK(make_studio(options, {standing}).floors.size() == 1);
    options.props[0].normal = {1, 0, 0};  // a wall is no floor
    CHECK(make_studio(options, {standing}).floors.size() == 2);
}

TEST_CASE("every light of the studio shines at the bodies") {
    for (const Vec3& up : {Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        Options options;
        options.up = up;
        const Vec3f center(10, 20, 30);
        const Vec3f half = Vec3f::Constant(0.5f);
        const Scene studio = make_studio(options, {{center - half, center + half}});
        REQUIRE_FALSE(studio.lights.empty());
        for (const RectangleLight& light : studio.lights)
            CHECK(light.half_u.cross(light.half_v).dot(center - light.center) > 0);
    }
}

TEST_CASE("surfaces take their colour from the look, the regions or the stretch") {
    assets::CachedSurface cached{"bar", "skin", cube_triangles, cube_positions, {}};
    cached.region_color.assign(8, Vec3f(0.1f, 0.2f, 0.3f));
    assets::SurfaceFrame frame{cube_positions, std::vector<Vec3f>(8, Vec3f::UnitX()), {}};
    frame.attributes["stretch"].assign(8, 2.5f);
    Look look;
    CHECK(Surface(cached, look).at(frame).colors[3] == Vec3f(0.1f, 0.2f, 0.3f));
    look.color_by = ColorBy::Look;
    look.color = Vec3f::Constant(128 / 255.0f);
    CHECK(Surface(cached, look).at(frame).colors[3].x() == Approx(0.2158605));
    look.color_by = ColorBy::Stretch;
    CHECK(Surface(cached, look).at(frame).colors[3] == stretch_color(2));
    frame.attributes.clear();
    CHECK_THROWS_AS(Surface(cached, look).at(frame), std::logic_error);
    frame.positions.pop_back();
    CHECK_THROWS_AS(Surface(cached, Look{}).at(frame), std::logic_error);
}

TEST_CASE("a varying surface is drawn with the triangles, normals and colours of its frame") {
    assets::CachedSurface cached;
    cached.body = "snow";
    cached.skin = "self";
    cached.varying = true;
    Look look;
    look.coated = false;
    const Surface surface(cached, look);
    for (const int n_triangles : {12, 1, 0}) {
        assets::SurfaceFrame frame{cube_positions, std::vector<Vec3f>(8, Vec3f::UnitY()), {}};
        frame.triangles.assign(cube_triangles.begin(), cube_triangles.begin() + n_triangles);
        frame.region_color.assign(8, Vec3f(0.9f, 1.2f, 0.8f));
        const Mesh mesh = surface.at(frame);
        CHECK(mesh.triangles == frame.triangles);
        CHECK(mesh.positions == frame.positions);
        CHECK(mesh.normals == frame.normals);  // no creases
        CHECK(mesh.colors[7] == Vec3f(0.9f, 1, 0.8f));
        CHECK_FALSE(mesh.material.coated);

        frame.attributes["stretch"].assign(8, 1.5f);
        Look by_stretch = look;
        by_stretch.color_by = ColorBy::Stretch;
        CHECK(Surface(cached, by_stretch).at(frame).colors[0] == stretch_color(1.5f));
        frame.region_color.pop_back();
        CHECK_THROWS_AS(surface.at(frame), std::logic_error);
    }
    look.opacity = 0.5f;
    CHECK_THROWS_WITH(Surface(cached, look), Catch::Contains("cannot be drawn clear"));
}

TEST_CASE("the colours of stretch grow ever brighter") {
    const auto luminance = [](float stretch) {
        return stretch_color(stretch).dot(Vec3f(0.2126f, 0.7152f, 0.0722f));  // Rec.709
    };
    for (float stretch = 1; stretch < 1.99f; stretch += 0.01f)
        CHECK(luminance(stretch + 0.01f) > luminance(stretch));
    CHECK(stretch_color(0.5f) == stretch_color(1));
}
