#include "shot_text.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace shots {

Folder::Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "supple_shot_XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path = name;
}

Folder::~Folder() {
    std::filesystem::remove_all(path);
}

std::filesystem::path Folder::write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return path / name;
}

const std::string& sound_shot() {
    static const std::string text = R"(format = 1
shot   = "test"
frames = "1-48"
fps    = 24
units  = { up = "z" }

[solver]
method = "enriched"
dt     = "1 ms"

[body.bar]
shape = { box = { min = [0, 0, 0], max = [1, 0.1, 0.1] } }
domain_size = "25 mm"

[[body.bar.region]]
name = "hard"
select = "all"
young_modulus = "1 MPa"
poisson_ratio = 0.3
density = 1000

[[body.bar.region]]
name = "soft"
select = { box = { min = [0.4, -1, -1], max = [0.6, 1, 1] } }
young_modulus = "100 kPa"

[[pin]]
name = "wall"
body = "bar"
select = { half_space = { point = [0, 0, 0], normal = [1, 0, 0] } }

[[force]]
gravity = [0, 0, "-9.81 m/s2"]

[[probe]]
name = "tip"
body = "bar"
point = [1, 0.05, 0.05]

[output]
size = [64, 36]
)";
    return text;
}

std::string with(const std::string& text,
                 const std::string& old_piece,
                 const std::string& new_piece) {
    const std::size_t at = text.find(old_piece);
    REQUIRE(at != std::string::npos);
    REQUIRE(text.find(old_piece, at + 1) == std::string::npos);
    return std::string(text).replace(at, old_piece.size(), new_piece);
}

Shot load_text(const std::string& text, const std::vector<std::string>& overrides) {
    const Folder folder;
    return load_shot(folder.write("test.toml", text), overrides);
}

std::vector<std::string> mistakes_of(const std::string& text,
                                     const std::vector<std::string>& overrides) {
    const Folder folder;
    const auto file = folder.write("test.toml", text);
    std::vector<std::string> lines;
    try {
        load_shot(file, overrides);
    } catch (const ShotFileError& error) {
        CHECK(error.kind() == assets::ErrorKind::Input);
        std::istringstream stream(error.what());
        for (std::string line; std::getline(stream, line);)
            lines.push_back(
                line.starts_with(file.string()) ? line.substr(file.string().size() + 1) : line);
    }
    return lines;
}

}  // namespace shots
