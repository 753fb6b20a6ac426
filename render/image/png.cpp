#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"
#include "render/image/image.h"
#include "render/image/view_transform.h"

#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <png.h>
#include <string_view>
#include <zlib.h>

namespace render {

namespace {

using Texts = std::map<std::string, std::string>;

std::vector<std::uint8_t> display_bytes(const Image& image) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * image.pixels.size());
    for (const Vec3f& pixel : image.pixels) {
        assets::check(pixel.allFinite(), "pixels are finite");
        const Vec3f shown = view_transform(pixel);
        for (int c = 0; c < 3; ++c)
            bytes.push_back(std::uint8_t(std::lround(255 * shown[c])));
    }
    return bytes;
}

void append(png_structp png, png_bytep data, png_size_t size) {
    static_cast<std::string*>(png_get_io_ptr(png))
        ->append(reinterpret_cast<const char*>(data), size);
}

void no_flush(png_structp) {}

// libpng reports errors by longjmp: nothing with a destructor may be created in here.
bool encode(png_structp png,
            png_infop info,
            const Image& image,
            const std::uint8_t* bytes,
            png_text* texts,
            int n) {
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_compression_level(png, 3);  // a fifth of the time of 9 for a few percent more bytes
    png_set_IHDR(png,
                 info,
                 png_uint_32(image.width),
                 png_uint_32(image.height),
                 8,
                 PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_text(png, info, texts, n);
    png_write_info(png, info);
    for (int row = 0; row < image.height; ++row)
        png_write_row(png, bytes + std::size_t(3) * image.width * row);
    png_write_end(png, info);
    return true;
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i)
        value = value << 8 | std::uint8_t(bytes[i]);
    return value;
}

struct Chunk {
    std::string_view type, data;
};

constexpr std::string_view signature("\x89PNG\r\n\x1a\n", 8);

// The chunks of a PNG from IHDR to IEND with every checksum right and nothing behind; otherwise empty.
std::vector<Chunk> whole_chunks(const std::string& file) {
    std::vector<Chunk> chunks;
    if (file.compare(0, signature.size(), signature) != 0)
        return {};
    for (std::size_t at = signature.size(); at < file.size();) {
        if (file.size() - at < 12)
            return {};
        const std::size_t length = big_endian(file, at);
        if (file.size() - at - 12 < length)
            return {};
        const auto* bytes = reinterpret_cast<const Bytef*>(file.data() + at + 4);
        if (crc32(crc32(0, nullptr, 0), bytes, uInt(length + 4))
            != big_endian(file, at + 8 + length))
            return {};
        const std::string_view view(file);
        chunks.push_back({view.substr(at + 4, 4), view.substr(at + 8, length)});
        at += 12 + length;
    }
    const bool whole =
        !chunks.empty() && chunks.front().type == "IHDR" && chunks.back().type == "IEND";
    return whole ? chunks : std::vector<Chunk>{};
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image, const Texts& text) {
    assets::check(image.width > 0 && image.height > 0, "a picture needs pixels");
    assets::check(image.pixels.size() == std::size_t(image.width) * image.height,
                  "pixels of a picture are missing");
    const std::vector<std::uint8_t> bytes = display_bytes(image);
    std::vector<png_text> texts;
    for (const auto& [key, value] : text) {
        assets::check(!key.empty() && key.size() < 80, "a PNG key has 1 to 79 characters");
        png_text entry{};
        entry.compression = PNG_TEXT_COMPRESSION_NONE;
        entry.key = const_cast<char*>(key.c_str());  // libpng only reads them
        entry.text = const_cast<char*>(value.c_str());
        texts.push_back(entry);
    }

    std::string encoded;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    assets::check(info != nullptr, "libpng starts");
    png_set_write_fn(png, &encoded, append, no_flush);
    const bool done = encode(png, info, image, bytes.data(), texts.data(), int(texts.size()));
    png_destroy_write_struct(&png, &info);
    assets::check(done, "libpng encodes a picture");
    assets::write_atomically(file, encoded);
}

Texts read_png_text(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    Texts texts;
    for (const Chunk& chunk : whole_chunks(bytes)) {
        const std::size_t end = chunk.data.find('\0');
        if (chunk.type == "tEXt" && end != std::string_view::npos)
            texts[std::string(chunk.data.substr(0, end))] = chunk.data.substr(end + 1);
    }
    return texts;
}

}  // namespace render
