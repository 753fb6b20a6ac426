#include "assets/base/error.h"
#include "assets/generators/solid.h"
#include "tests/unit/assets/generators/obj_file.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <cmath>

using namespace assets;

namespace {

TriangleMesh sphere_mesh() {
    return make_surface({Shape(Sphere{{0, 0, 0}, 1}), {}}, 0.04).mesh;
}

std::string message_of(const Source& source, double voxel) {
    try {
        make_solid(source, voxel, 3 * voxel);
    } catch (const Error& error) {
        CHECK(error.kind() == ErrorKind::Input);
        return error.what();
    }
    return "no error";
}

}  // namespace

TEST_CASE(
    "the level set of a mesh has the mesh's distances within the band, and signs beyond it") {
    const ObjFile file("supple_sphere", sphere_mesh());
    // Chords and trilinear cells err by a thirtieth of these voxels. OpenVDB, which passes the
    // nearest triangle on from voxel to voxel, may miss a slightly nearer one.
    constexpr double voxel = 0.05, band = 0.2;
    // Single precision would lose the band here, were it not relative to the mesh.
    const double translate = 1000;
    const auto solid =
        make_solid({MeshFile{file.path()}, {2, {0, 0, 0}, {translate, 0, 0}}}, voxel, band);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 d = 3 * Vec3::Random();
        const double exact = d.norm() - 2,
                     found = solid->signed_distance(Vec3(translate, 0, 0) + d);
        if (std::abs(exact) < band)
            CHECK(std::abs(found - exact) < 0.1 * voxel);
        else
            CHECK((found * exact > 0 && std::abs(found) >= band));
    }
    CHECK(solid->min.x() == Approx(translate - 2).epsilon(1e-6));
    CHECK(solid->max.z() == Approx(2).epsilon(0.001));
}

TEST_CASE("an open mesh is closed where that can be, and that is told") {
    TriangleMesh mesh = make_surface({Shape(Box{{0, 0, 0}, {1, 1, 1}}), {}}, 0.5).mesh;
    mesh.triangles.pop_back();
    const ObjFile file("supple_open_box", mesh);
    std::vector<std::string> repairs;
    const auto solid = make_solid(file.source(), 0.1, 0.3, &repairs);
    CHECK(repairs.size() >= 1);
    CHECK(solid->signed_distance({0.5, 0.5, 0.5}) <= -0.3);
    CHECK(solid->signed_distance({0.5, 0.5, 1.2}) == Approx(0.2).epsilon(0.01));
}

TEST_CASE("a mesh without an inside is refused") {
    TriangleMesh sheet;
    sheet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {1, 3, 2}};
    const ObjFile file("supple_sheet", sheet);
    CHECK(message_of(file.source(), 0.1) != "no error");
}

TEST_CASE("three sheets along one edge are refused with the number of open edges") {
    TriangleMesh sheets;
    sheets.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    sheets.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    const ObjFile file("supple_sheets", sheets);
    CHECK_THAT(message_of(file.source(), 0.1), Catch::Contains("6 edges are open"));
}

TEST_CASE("walls too thin for the voxels are refused") {
    const ObjFile file("supple_plate",
                       make_surface({Shape(Box{{0, 0, 0}, {1, 1, 0.01}}), {}}, 0.5).mesh);
    CHECK_THAT(message_of(file.source(), 0.1), Catch::Contains("thinner"));
    CHECK(message_of(file.source(), 0.002) == "no error");
}

TEST_CASE("level sets are the same for any number of threads") {
    const ObjFile file("supple_threads", sphere_mesh());
    const auto with_all = make_solid(file.source(), 0.05, 0.2);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto with_one = make_solid(file.source(), 0.05, 0.2);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 x = 1.3 * Vec3::Random();
        CHECK(with_all->signed_distance(x) == with_one->signed_distance(x));
    }
}
