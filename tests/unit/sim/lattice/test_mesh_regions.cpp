#include "assets/base/error.h"
#include "tests/unit/assets/generators/obj_file.h"
#include "tests/unit/sim/lattice/bodies.h"

#include <catch2/catch.hpp>

using namespace sim;

namespace {

/// A bar of 4 × 1 × 1 m whose triangles with x < 2 are muscle and others bone.
assets::TriangleMesh bar_of_two_materials() {
    assets::TriangleMesh mesh =
        assets::make_surface({assets::Shape(assets::Box{{0, 0, 0}, {4, 1, 1}}), {}}, 0.5).mesh;
    mesh.groups = {"Muscle", "Bone"};
    for (const auto& [a, b, c] : mesh.triangles)
        mesh.triangle_group.push_back(
            (mesh.positions[a].x() + mesh.positions[b].x() + mesh.positions[c].x()) / 3 < 2
                ? 0
                : 1);
    return mesh;
}

Body body_of(const ObjFile& file, double domain_size) {
    Body made = body(assets::Box{}, domain_size);
    made.source = file.source();
    return made;
}

}  // namespace

TEST_CASE("a mesh of a box is cut as the box is") {
    const ObjFile file("supple_bar", bar_of_two_materials());
    const Lattice lattice = make_lattice(body_of(file, 0.25));
    CHECK(lattice.n_domains() == 16 * 4 * 4);
    for (const double fill : lattice.fill)
        CHECK(fill == 1);
}

TEST_CASE("a mesh material selects what is nearest to its triangles") {
    const ObjFile file("supple_bar", bar_of_two_materials());
    Body bar = body_of(file, 0.25);
    bar.regions.push_back(region("muscle", {Selector::MeshMaterial{"Mus*"}, {}}));
    const Lattice lattice = make_lattice(bar);
    CHECK(lattice.region_volume[1] == Approx(2).epsilon(0.001));
    for (int p = 0; p < lattice.n_domains(); ++p)
        CHECK(lattice.region[p] == (lattice.cell[p][0] < 8 ? 1 : 0));
    // Corners on the border belong to the part, as with any selector.
    CHECK(select_corners(lattice, bar, {Selector::MeshMaterial{"Muscle"}, {}}).size()
          == 9 * 25);
}

TEST_CASE("an unknown mesh material is an error that lists those there are") {
    const ObjFile file("supple_bar", bar_of_two_materials());
    Body bar = body_of(file, 0.25);
    bar.regions.push_back(region("muscle", {Selector::MeshMaterial{"Musle*"}, {}}));
    try {
        make_lattice(bar);
        FAIL("no error");
    } catch (const assets::Error& error) {
        CHECK(error.key() == "body.b.region.muscle.select");
        CHECK_THAT(
            error.what(),
            Catch::Contains("Muscle, Bone") && Catch::Contains("did you mean \"Muscle\""));
    }
}

TEST_CASE("the inside of a mesh selects its volume") {
    const ObjFile ball(
        "supple_ball",
        assets::make_surface({assets::Shape(assets::Sphere{{0, 0, 0}, 0.5}), {}}, 0.02).mesh);
    Body cube = body(assets::Box{{-1, -1, -1}, {1, 1, 1}}, 0.1);
    cube.regions.push_back(region("core", {Selector::Inside{ball.path()}, {}}));
    const Lattice lattice = make_lattice(cube);
    CHECK(lattice.region_volume[1] == Approx(4.0 / 3 * std::acos(-1.0) * 0.125).epsilon(0.005));
}

TEST_CASE("a missing mesh of a selector is an error with the selector's key") {
    Body cube = body(assets::Box{{-1, -1, -1}, {1, 1, 1}}, 0.5);
    cube.regions.push_back(region("core", {Selector::Inside{"no/such.obj"}, {}}));
    try {
        make_lattice(cube);
        FAIL("no error");
    } catch (const assets::Error& error) {
        CHECK(error.key() == "body.b.region.core.select");
        CHECK_THAT(error.what(), Catch::Contains("no/such.obj"));
    }
}

TEST_CASE("a body's missing mesh is an error with the body's key") {
    Body missing = body(assets::Box{}, 0.5);
    missing.source.geometry = assets::MeshFile{"no/such.obj"};
    try {
        make_lattice(missing);
        FAIL("no error");
    } catch (const assets::Error& error) {
        CHECK(error.key() == "body.b.mesh");
    }
}
