// Whatever is in a file, there is a mesh or an Error that names it.
#include "assets/base/error.h"
#include "tests/unit/assets/mesh/mesh_files.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using assets::Error;
using assets::import_mesh;

namespace {

// The message of the input error that importing the file must throw.
std::string message_of(const std::filesystem::path& file) {
    try {
        import_mesh(file);
    } catch (const Error& error) {
        CHECK(error.kind() == assets::ErrorKind::Input);
        CHECK_THAT(error.what(), Catch::Contains(file.string()));
        return error.what();
    }
    FAIL("no error for " << file);
    return {};
}

std::string message_of(const std::string& name, const std::string& content) {
    const TemporaryFolder folder;
    return message_of(folder.write(name, content));
}

void check_is_sound(const assets::TriangleMesh& mesh) {
    REQUIRE(!mesh.triangles.empty());
    for (const Vec3& x : mesh.positions)
        REQUIRE(x.allFinite());
    for (const auto& triangle : mesh.triangles) {
        for (const int v : triangle)
            REQUIRE((v >= 0 && v < static_cast<int>(mesh.positions.size())));
    }
    REQUIRE((mesh.groups.empty() || mesh.triangle_group.size() == mesh.triangles.size()));
}

std::string mutated(std::string text, std::mt19937& random) {
    const int n_changes = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < n_changes && !text.empty(); ++i) {
        const size_t at = random() % text.size();
        switch (random() % 4) {
            case 0:
                text[at] = static_cast<char>(random() % 256);
                break;
            case 1:
                text.erase(at, 1 + random() % 20);
                break;
            case 2:
                text.insert(at, text.substr(random() % text.size(), 1 + random() % 20));
                break;
            default:
                text[at] = "0123456789.-e \n"[random() % 15];
                break;
        }
    }
    return text;
}

}  // namespace

TEST_CASE("A missing file is named, with the nearest name in its folder") {
    const TemporaryFolder folder;
    folder.write("frog.obj", "");
    folder.write("unrelated_thing.obj", "");
    CHECK_THAT(message_of(folder.path() / "frgo.obj"),
               Catch::Contains("did you mean") && Catch::Contains("frog.obj"));
    CHECK_THAT(message_of(folder.path() / "zzzzzzzzz.ply"), !Catch::Contains("did you mean"));
    CHECK_THAT(message_of(folder.path() / "nowhere" / "frog.obj"),
               Catch::Contains("does not exist"));
    CHECK_THAT(message_of(folder.path()), Catch::Contains("not a file"));
}

TEST_CASE("A format that cannot be read is named, with some that can") {
    CHECK_THAT(message_of("frog.usdz", "x"),
               Catch::Contains(".usdz") && Catch::Contains("obj, ply, stl"));
    CHECK_THAT(message_of("frog", "x"), Catch::Contains("obj, ply, stl"));
    CHECK_THAT(message_of("frog.glb", "not a glb at all"),
               Catch::Contains("cannot be read as glb"));
}

TEST_CASE("A file without a surface is refused") {
    CHECK_THAT(message_of("empty.obj", ""), Catch::Contains("cannot be read"));
    CHECK_THAT(message_of("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
               Catch::Contains("mesh"));
    CHECK_THAT(message_of("line.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"),
               Catch::Contains("no triangles"));
    CHECK_THAT(message_of("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"),
               Catch::Contains("no size"));
    CHECK_THAT(message_of("flat.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n"),
               Catch::Contains("no triangles"));
}

TEST_CASE("Coordinates that are not finite are refused with their vertex") {
    CHECK_THAT(message_of("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n"),
               Catch::Contains("vertex 3") && Catch::Contains("(0, nan, 0)"));
    CHECK_THAT(
        message_of("inf.ply", as_ply({{{0, 0, 0}, {1, 0, 0}, {0, INFINITY, 0}}, {{0, 1, 2}}})),
        Catch::Contains("vertex 3") && Catch::Contains("inf"));
}

TEST_CASE("Files cut short are refused") {
    const auto without_last_line = [](const std::string& content) {
        return content.substr(0, content.rfind('\n', content.size() - 2) + 1);
    };
    const Polygons polygons = box({0, 0, 0}, {1, 1, 1});
    CHECK_THAT(message_of("cut.ply", without_last_line(as_ply(polygons))),
               Catch::Contains("ends early"));
    CHECK_THAT(message_of("cut.off", without_last_line(as_off(polygons))),
               Catch::Contains("incomplete"));
    CHECK_THAT(message_of("cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"), Catch::Contains("mesh"));

    const std::string header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n";
    CHECK_THAT(message_of("cut_binary.ply", header + std::string(36, '\0')),
               Catch::Contains("ends early"));
}

TEST_CASE("A ply whose header is none is refused") {
    const std::string rest = "property float x\nend_header\n0\n";
    CHECK_THAT(message_of("count.ply", "ply\nformat ascii 1.0\nelement vertex many\n" + rest),
               Catch::Contains("header"));
    CHECK_THAT(
        message_of("huge.ply", "ply\nformat ascii 1.0\nelement vertex 2000000000\n" + rest),
        Catch::Contains("ends early"));
    CHECK_THAT(
        message_of("type.ply",
                   "ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n0\n"),
        Catch::Contains("header"));
}

TEST_CASE("Files changed at random give a mesh or an error") {
    const Polygons polygons = box({0, 0, 0}, {1, 2, 3}) + box({0.2, 0.2, 0.2}, {0.4, 0.4, 0.4});
    std::mt19937 random(20240229);
    const TemporaryFolder folder;
    int n_meshes = 0;
    int n_errors = 0;
    for (const auto& [name, content] :
         {std::pair<std::string, std::string>{"m.obj", as_obj(polygons)},
          {"m.ply", as_ply(polygons)},
          {"m.stl", as_stl(polygons)}}) {
        for (int i = 0; i < 200; ++i) {
            INFO(name << " changed the " << i << "th time");
            const auto file = folder.write(name, mutated(content, random));
            try {
                check_is_sound(import_mesh(file).mesh);
                ++n_meshes;
            } catch (const Error&) {
                ++n_errors;
            }
        }
    }
    CHECK(n_meshes > 50);  // both ways are tried
    CHECK(n_errors > 50);
}
