// The folder tree is the architecture: every #include points along an allowed arrow.
#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace fs = std::filesystem;

namespace {

using Names = std::set<std::string>;
using Arrows = std::map<std::string, Names>;

// Folder -> what it may include beside itself: folders, or single headers. A part's name alone stands for the files
// right in it; "part/*" for the part and all its folders.
const Arrows allowed = {
    {"assets/base", {}},
    {"assets/mesh", {"assets/base"}},
    {"assets/generators", {"assets/base", "assets/mesh"}},
    {"assets/frames", {"assets/base"}},

    {"sim", {"sim/*", "assets/*"}},
    {"sim/base", {"assets/*"}},
    {"sim/materials", {"assets/*", "sim/scene.h", "sim/base"}},
    {"sim/lattice", {"assets/*", "sim/scene.h", "sim/base"}},
    {"sim/solver", {"assets/*", "sim/base"}},
    {"sim/grid", {"assets/*", "sim/scene.h", "sim/base"}},
    {"sim/points",
     {"assets/*", "sim/scene.h", "sim/base", "sim/grid", "sim/materials", "sim/lattice"}},
    {"sim/elasticity", {"assets/*", "sim/scene.h", "sim/base", "sim/materials", "sim/lattice"}},
    {"sim/contact",
     {"assets/*",
      "sim/scene.h",
      "sim/base",
      "sim/grid",
      "sim/materials",
      "sim/lattice",
      "sim/embedding"}},
    {"sim/enrichment", {"assets/*", "sim/scene.h", "sim/base", "sim/lattice"}},
    {"sim/embedding", {"assets/*", "sim/lattice"}},

    {"render", {"render/*", "assets/*"}},
    {"render/image", {"assets/*"}},
    {"render/scene", {"assets/*", "render/options.h", "render/image"}},
    {"render/pathtrace", {"assets/*", "render/scene", "render/image"}},

    {"shots", {"shots/*", "assets/*", "sim/*", "render/*"}},
    {"shots/text", {"assets/*"}},
    {"shots/reading",
     {"shots/text", "shots/shot.h", "assets/*", "sim/scene.h", "render/options.h"}},
    {"shots/stages", {"shots/text", "shots/shot.h", "assets/*", "sim/*", "render/*"}},
};

// Third-party header, or the folder it lies in -> the only folders that may include it.
const Arrows homes = {
    {"openvdb", {"assets/generators"}},
    {"assimp", {"assets/mesh"}},
    {"blosc.h", {"assets/frames"}},
    {"nlohmann", {"assets/frames", "shots"}},
    {"embree3", {"render/pathtrace"}},
    {"png.h", {"render/image"}},
    {"toml++", {"shots/reading"}},
    {"CLI", {"shots"}},
    {"catch2", {}},
};

std::string part_of(const std::string& path) {
    return path.substr(0, path.find('/'));
}

bool may_include(const std::string& folder, const std::string& header) {
    const std::string from = fs::path(header).parent_path().string();
    if (from == folder)
        return true;
    const Names& names = allowed.at(folder);
    return names.count(from) || names.count(header) || names.count(part_of(header) + "/*");
}

bool is_home(const std::string& folder, const std::string& header) {
    const auto home = homes.find(part_of(header));
    return home == homes.end() || home->second.count(folder);
}

void check_file(const fs::path& path, const std::string& folder) {
    static const std::regex include(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::smatch match;
        if (!std::regex_search(line, match, include))
            continue;
        INFO(path.string() << ": " << line);
        const std::string header = match[2];
        if (match[1] == "<") {
            CHECK(is_home(folder, header));
        } else {
            CHECK(fs::exists(fs::path(SOURCE_ROOT) / header));  // written from the root
            CHECK(may_include(folder, header));
        }
    }
}

}  // namespace

TEST_CASE("includes follow the allowed direction, and third-party headers stay at home") {
    int n_files = 0;
    for (const std::string part : {"assets", "sim", "render", "shots"})
        for (const auto& entry :
             fs::recursive_directory_iterator(fs::path(SOURCE_ROOT) / part)) {
            const fs::path& path = entry.path();
            if (path.extension() != ".h" && path.extension() != ".cpp")
                continue;
            const std::string folder = fs::relative(path.parent_path(), SOURCE_ROOT).string();
            INFO(folder);
            REQUIRE(allowed.count(folder) == 1);
            check_file(path, folder);
            ++n_files;
        }
    CHECK(n_files > 100);
}

TEST_CASE("the table of arrows forbids what it should") {
    CHECK(may_include("sim/grid", "sim/base/field.h"));
    CHECK(may_include("sim/elasticity", "sim/scene.h"));
    CHECK_FALSE(may_include("sim/solver", "sim/materials/law.h"));
    CHECK_FALSE(may_include("sim/grid", "sim/simulation.h"));
    CHECK_FALSE(may_include("render", "sim/simulation.h"));
    CHECK_FALSE(may_include("sim", "render/render.h"));
    CHECK_FALSE(may_include("assets/base", "assets/mesh/triangle_mesh.h"));
    CHECK_FALSE(is_home("sim", "openvdb/openvdb.h"));
    CHECK_FALSE(is_home("render", "embree3/rtcore.h"));
    CHECK(is_home("sim/solver", "vector"));
}
