#include "render/image/image.h"
#include "render/image/view_transform.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <png.h>
#include <unistd.h>

using namespace render;
namespace fs = std::filesystem;

namespace {

// A folder of its own that goes with the test.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("supple_test_png_" + std::to_string(getpid()));

    Folder() { fs::create_directories(path); }

    ~Folder() { fs::remove_all(path); }
};

Image gradient(int width, int height) {
    Image image{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.pixels.emplace_back(float(x) / float(width), float(y) / float(height), 0.2f);
    return image;
}

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::uint8_t> decoded(const fs::path& file) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_file(&png, file.c_str()));
    png.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(png));
    REQUIRE(png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr));
    return bytes;
}

const std::map<std::string, std::string> texts{{"supple", "frame 7\nkey 0123"}, {"note", ""}};

}  // namespace

TEST_CASE("a PNG holds the pixels in sRGB and its text") {
    const Folder folder;
    const fs::path file = folder.path / "a.png";
    const Image image = gradient(37, 11);
    write_png(file, image, texts);
    CHECK(read_png_text(file) == texts);
    const std::vector<std::uint8_t> bytes = decoded(file);
    REQUIRE(bytes.size() == 3 * image.pixels.size());
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (image.pixels[i][c] < shoulder_start) {
                const double x = image.pixels[i][c];
                const double srgb =
                    x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
                REQUIRE(std::abs(bytes[3 * i + c] - 255 * srgb) <= 0.51);
            }
}

TEST_CASE("nothing but the PNG is left in the folder, and an old one is replaced") {
    const Folder folder;
    const fs::path file = folder.path / "a.png";
    write_png(file, gradient(64, 64), {{"version", "old"}});
    write_png(file, gradient(32, 32), {{"version", "new"}});
    CHECK(read_png_text(file).at("version") == "new");
    CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator{}) == 1);
}

TEST_CASE("damaged and missing files have no text") {
    const Folder folder;
    const fs::path file = folder.path / "a.png", broken = folder.path / "b.png";
    write_png(file, gradient(5, 4), texts);
    const std::string whole = bytes_of(file);
    const auto text_of = [&](const std::string& bytes) {
        std::ofstream(broken, std::ios::binary) << bytes;
        return read_png_text(broken);
    };
    REQUIRE(text_of(whole) == texts);
    for (std::size_t length = 0; length < whole.size(); ++length)
        REQUIRE(text_of(whole.substr(0, length)).empty());
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string flipped = whole;
        flipped[at] = char(flipped[at] ^ 0x10);
        REQUIRE(text_of(flipped).empty());
    }
    CHECK(text_of(whole + "x").empty());
    CHECK(read_png_text(folder.path / "missing.png").empty());
}

TEST_CASE("a pixel that is not finite never reaches a file") {
    const Folder folder;
    const fs::path file = folder.path / "a.png";
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Image image = gradient(8, 8);
        image.pixels[13].y() = bad;
        CHECK_THROWS_AS(write_png(file, image, {}), std::logic_error);
    }
    CHECK_FALSE(fs::exists(file));
}

TEST_CASE("the sRGB curve has the values of its standard") {
    // IEC 61966-2-1: code 128 of 255 is linear 0.2158605, code 10 is 0.0030353 (on the straight part).
    CHECK(linear_from_srgb(128 / 255.0f) == Approx(0.2158605).epsilon(1e-5));
    CHECK(linear_from_srgb(10 / 255.0f) == Approx(0.0030353).epsilon(1e-4));
    CHECK(srgb_from_linear(0.2158605f) == Approx(128 / 255.0).epsilon(1e-5));
    for (int code = 0; code < 256; ++code)
        CHECK(255 * srgb_from_linear(linear_from_srgb(float(code) / 255))
              == Approx(code).margin(1e-3));
}

TEST_CASE("the tone curve keeps typed colours, rises everywhere and stays below white") {
    const Vec3f typed(0.1f, 0.55f, 0.75f);  // sRGB; 0.75 is linear 0.52, below the shoulder
    CHECK((view_transform(linear_from_srgb(typed)) - typed).norm() < 1e-5f);
    CHECK(view_transform(Vec3f(-1, 0, 1e6f)).minCoeff() == 0);
    float before = -1;
    for (float x = 0; x < 4; x += 0.01f) {
        const float shown = view_transform(Vec3f::Constant(x)).x();
        CHECK(shown > before);
        CHECK(shown < 1);
        before = shown;
    }
    // No kink where the shoulder begins: the slope on both sides, in linear light.
    const auto slope = [](float x) {
        const auto curve = [](float y) {
            return linear_from_srgb(view_transform(Vec3f::Constant(y)).x());
        };
        return (curve(x + 1e-3f) - curve(x - 1e-3f)) / 2e-3f;
    };
    CHECK(slope(shoulder_start + 2e-3f) == Approx(slope(shoulder_start - 2e-3f)).margin(0.02));
}
