// The same box, 1 x 2 x 3 m and off the origin so that no axis can be mistaken, in every format.
#include "tests/unit/assets/mesh/mesh_files.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstring>
#include <fmt/format.h>

using assets::import_mesh;
using assets::ImportedMesh;

namespace {

const Vec3 box_min(0.5, 1, 2);
const Vec3 box_max(1.5, 3, 5);

Polygons crate() {
    return box(box_min, box_max);
}

void check_is_crate(const ImportedMesh& imported) {
    const assets::TriangleMesh& mesh = imported.mesh;
    CHECK(imported.closed);
    REQUIRE(mesh.positions.size() == 8);
    CHECK(mesh.triangles.size() == 12);
    CHECK(signed_volume(mesh) == Approx(6).epsilon(1e-6));  // single precision of the loader
    Vec3 low = mesh.positions[0];
    Vec3 high = low;
    for (const Vec3& x : mesh.positions) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    CHECK((low - box_min).norm() < 1e-6);
    CHECK((high - box_max).norm() < 1e-6);
}

template <class T>
std::string bytes_of(const T& value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return bytes;
}

std::string reversed_if(bool reverse, std::string bytes) {
    if (reverse)
        std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

// With properties and an element that do not matter here.
std::string as_binary_ply(const Polygons& polygons, bool big_endian) {
    std::string text = fmt::format(
        "ply\r\nformat binary_{}_endian 1.0\r\ncomment of no matter\r\nelement vertex {}\r\n"
        "property uchar red\r\nproperty double x\r\nproperty double y\r\nproperty double z\r\n"
        "element edge 1\r\nproperty short vertex1\r\nelement face {}\r\n"
        "property list uchar ushort vertex_index\r\nproperty list uint float "
        "weight\r\nend_header\n",
        big_endian ? "big" : "little",
        polygons.positions.size(),
        polygons.faces.size());
    for (const Vec3& p : polygons.positions) {
        text += '\7';
        for (int i = 0; i < 3; ++i)
            text += reversed_if(big_endian, bytes_of(p[i]));
    }
    text += std::string(2, '\1');
    for (const std::vector<int>& face : polygons.faces) {
        text += static_cast<char>(face.size());
        for (const int v : face)
            text += reversed_if(big_endian, bytes_of(static_cast<uint16_t>(v)));
        text += reversed_if(big_endian, bytes_of(uint32_t{1})) + bytes_of(0.0f);
    }
    return text;
}

std::string base64(const std::string& bytes) {
    const std::string digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        unsigned block = 0;
        for (size_t k = 0; k < 3; ++k)
            block = block << 8
                    | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : digits[block >> (18 - 6 * k) & 63];
    }
    return text;
}

// The box moved back by `scale` and `translation`, which the node then applies.
std::string as_gltf(const Polygons& polygons, const Vec3& scale, const Vec3& translation) {
    std::string buffer;
    for (const Vec3& p : polygons.positions) {
        const Vec3 local = (p - translation).cwiseQuotient(scale);
        for (int i = 0; i < 3; ++i)
            buffer += bytes_of(static_cast<float>(local[i]));
    }
    const size_t positions_size = buffer.size();
    const bool mirrored = scale.prod() < 0;  // a mirroring node turns faces over
    for (const std::vector<int>& f : polygons.faces) {
        for (const int k : {0, 1, 2, 0, 2, 3})
            buffer += bytes_of(static_cast<uint16_t>(f[mirrored ? 3 - k : k]));
    }
    return fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0,"scale":[{},{},{}],"translation":[{},{},{}]}}],
        "materials":[{{"name":"Wood"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[-99,-99,-99],"max":[99,99,99]}},
                     {{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":72}}],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}})",
        scale.x(),
        scale.y(),
        scale.z(),
        translation.x(),
        translation.y(),
        translation.z(),
        positions_size,
        positions_size,
        buffer.size(),
        base64(buffer));
}

// A chunk of a 3ds file.
std::string chunk(uint16_t id, const std::string& content) {
    return bytes_of(id) + bytes_of(static_cast<uint32_t>(content.size() + 6)) + content;
}

std::string as_3ds(const Polygons& polygons) {
    std::string positions = bytes_of(static_cast<uint16_t>(polygons.positions.size()));
    for (const Vec3& p : polygons.positions) {
        for (int i = 0; i < 3; ++i)
            positions += bytes_of(static_cast<float>(p[i]));
    }
    std::string faces = bytes_of(static_cast<uint16_t>(2 * polygons.faces.size()));
    for (const std::vector<int>& f : polygons.faces) {
        for (const int v :
             {f[0], f[1], f[2], 0, f[0], f[2], f[3], 0})  // each followed by its flags
            faces += bytes_of(static_cast<uint16_t>(v));
    }
    const std::string mesh = chunk(0x4100, chunk(0x4110, positions) + chunk(0x4120, faces));
    const std::string version = chunk(0x0002, bytes_of(uint32_t{3}));
    return chunk(0x4d4d,
                 version + chunk(0x3d3d, chunk(0x4000, std::string("crate\0", 6) + mesh)));
}

// Text fbx, with one unit of `centimetres`. The last corner of a face is stored as its complement.
std::string as_fbx(const Polygons& polygons, double centimetres) {
    std::vector<double> coordinates;
    for (const Vec3& p : polygons.positions) {
        for (int i = 0; i < 3; ++i)
            coordinates.push_back(p[i] * 100 / centimetres);
    }
    std::vector<int> corners;
    for (const std::vector<int>& f : polygons.faces)
        corners.insert(corners.end(), {f[0], f[1], f[2], ~f[3]});
    return fmt::format(
        "; FBX 7.3.0 project file\n"
        "FBXHeaderExtension:  {{\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7300\n}}\n"
        "GlobalSettings:  {{\n\tVersion: 1000\n\tProperties70:  {{\n"
        "\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{}\n\t}}\n}}\n"
        "Objects:  {{\n"
        "\tGeometry: 10, \"Geometry::crate\", \"Mesh\" {{\n"
        "\t\tVertices: *{} {{\n\t\t\ta: {}\n\t\t}}\n"
        "\t\tPolygonVertexIndex: *{} {{\n\t\t\ta: {}\n\t\t}}\n\t\tGeometryVersion: 124\n\t}}\n"
        "\tModel: 20, \"Model::crate\", \"Mesh\" {{\n\t\tVersion: 232\n\t}}\n}}\n"
        "Connections:  {{\n\tC: \"OO\",20,0\n\tC: \"OO\",10,20\n}}\n",
        centimetres,
        coordinates.size(),
        fmt::join(coordinates, ","),
        corners.size(),
        fmt::join(corners, ","));
}

}  // namespace

TEST_CASE("A box reads the same from every format") {
    const TemporaryFolder folder;
    const std::vector<std::pair<std::string, std::string>> files = {
        {"box.obj", as_obj(crate())},
        {"box.OFF", as_off(crate())},
        {"box.ply", as_ply(crate())},
        {"box_little.ply", as_binary_ply(crate(), false)},
        {"box_big.ply", as_binary_ply(crate(), true)},
        {"box.stl", as_stl(crate())},
        {"box.gltf", as_gltf(crate(), Vec3(1, 1, 1), Vec3(0, 0, 0))},
        {"box.3ds", as_3ds(crate())}};
    for (const auto& [name, content] : files) {
        INFO(name);
        const ImportedMesh imported = import_mesh(folder.write(name, content));
        check_is_crate(imported);
        CHECK(imported.repairs.empty());
    }
}

TEST_CASE("Off files may carry colours, comments, and the counts on their first line") {
    std::string off = "COFF 8 6 12  # counts\n\n";
    for (const Vec3& p : crate().positions)
        off += fmt::format("{} {} {} 255 0 0 255\n", p.x(), p.y(), p.z());
    for (const std::vector<int>& face : crate().faces)
        off += fmt::format("4 {} 0.5 0.5 0.5\n", fmt::join(face, " "));
    const TemporaryFolder folder;
    check_is_crate(import_mesh(folder.write("box.off", off)));
}

TEST_CASE("An fbx is converted from its unit to metres, and that is told") {
    const TemporaryFolder folder;
    const ImportedMesh inches = import_mesh(folder.write("box.fbx", as_fbx(crate(), 2.54)));
    check_is_crate(inches);
    CHECK(tells(inches.repairs, "units of 0.0254 m"));
    check_is_crate(import_mesh(folder.write("box_cm.fbx", as_fbx(crate(), 1))));
    const ImportedMesh metres = import_mesh(folder.write("box_m.fbx", as_fbx(crate(), 100)));
    check_is_crate(metres);
    CHECK(metres.repairs.empty());
}

TEST_CASE("Node transforms are applied, mirroring ones without a repair") {
    const TemporaryFolder folder;
    const auto file =
        folder.write("moved.gltf", as_gltf(crate(), Vec3(2, 0.5, 4), Vec3(7, -8, 9)));
    check_is_crate(import_mesh(file));
    const auto mirror =
        folder.write("mirror.gltf", as_gltf(crate(), Vec3(-1, 2, 1), Vec3(0, 1, 0)));
    const ImportedMesh mirrored = import_mesh(mirror);
    check_is_crate(mirrored);
    CHECK(mirrored.repairs.empty());
    CHECK(mirrored.mesh.groups == std::vector<std::string>{"Wood"});
}

TEST_CASE("Materials name the groups, and where there is none the groups of the file") {
    const Polygons two = box({0, 0, 0}, {1, 1, 1}) + box({2, 0, 0}, {3, 1, 1});
    std::string obj = as_obj(two);
    const size_t sixth_face = obj.find("f 9 ");
    const ImportedMesh unnamed = import_obj(obj);
    CHECK(unnamed.mesh.groups.empty());
    CHECK(unnamed.mesh.triangle_group.empty());

    const std::string first_faces = obj.substr(0, sixth_face);
    const std::string last_faces = obj.substr(sixth_face);
    const size_t first_face = obj.find("f 1 ");
    const std::string positions = obj.substr(0, first_face);
    const std::string first_box = obj.substr(first_face, sixth_face - first_face);

    const ImportedMesh groups =
        import_obj(positions + "g left\n" + first_box + "g right\n" + last_faces);
    CHECK(groups.mesh.groups == std::vector<std::string>{"left", "right"});
    const ImportedMesh materials = import_obj(positions + "g left\nusemtl Bone\n" + first_box
                                              + "g right\nusemtl Flesh\n" + last_faces);
    CHECK(materials.mesh.groups == std::vector<std::string>{"Bone", "Flesh"});
    const ImportedMesh partly =
        import_obj(first_faces + "o right\nusemtl Flesh\n" + last_faces);
    CHECK(partly.mesh.groups == std::vector<std::string>{"unnamed", "Flesh"});

    // Each group holds the triangles of its own box.
    for (const ImportedMesh* imported : {&groups, &materials, &partly}) {
        REQUIRE(imported->mesh.triangle_group.size() == 24);
        for (size_t t = 0; t < 24; ++t) {
            const bool right =
                imported->mesh.positions[imported->mesh.triangles[t][0]].x() > 1.5;
            CHECK(imported->mesh.triangle_group[t] == (right ? 1 : 0));
        }
    }
}
