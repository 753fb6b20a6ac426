// Pixels in linear Rec.709, and files of them.
#pragma once

#include "assets/base/vector_types.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace render {

struct Image {
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;  // row by row from the top, linear Rec.709
};

/// Writes 8-bit sRGB, atomically, with `text` as PNG text chunks. The tone curve is that of view_transform().
void write_png(const std::filesystem::path& file,
               const Image& image,
               const std::map<std::string, std::string>& text);

/// The text chunks of a PNG; empty where the file is missing or not a whole PNG.
std::map<std::string, std::string> read_png_text(const std::filesystem::path& file);

}  // namespace render
