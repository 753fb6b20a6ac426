#include "assets/frames/manifest.h"

#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"
#include "assets/frames/checksum.h"
#include "assets/frames/layout.h"

#include <fmt/core.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace assets {
namespace {

using Json = nlohmann::json;

constexpr int version = 2;

/// Text that is not UTF-8 (file names) is stored with replacements; the digest still tells it apart.
std::string text_of(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
    throw Error(ErrorKind::Input,
                fmt::format("{} {}; simulate again with --overwrite", path.string(), what));
}

Manifest parse(const std::filesystem::path& path, Json json) {
    const int found_version = json.at("version");
    if (found_version != version)
        refuse(path,
               fmt::format(
                   "has format version {}, this program reads {}", found_version, version));
    const std::string found_checksum = json.at("checksum");
    json.erase("checksum");
    if (found_checksum != hexadecimal(checksum(text_of(json, -1))))
        refuse(path, "is damaged: wrong checksum");
    return {json.at("fingerprint"),
            json.at("digest"),
            json.at("frames"),
            json.at("surfaces_checksum"),
            json.at("surfaces")};
}

}  // namespace

void write_manifest(const std::filesystem::path& folder, const Manifest& manifest) {
    Json json{{"version", version},
              {"digest", manifest.digest},
              {"fingerprint", manifest.fingerprint},
              {"frames", manifest.frame_numbers},
              {"surfaces_checksum", manifest.surfaces_checksum},
              {"surfaces", manifest.surface_names}};
    json["checksum"] = hexadecimal(checksum(text_of(json, -1)));
    write_atomically(folder / manifest_name, text_of(json, 1) + "\n");
}

std::optional<Manifest> read_manifest(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / manifest_name;
    std::ifstream file(path);
    if (!file) {
        if (std::error_code ignored; std::filesystem::symlink_status(path, ignored).type()
                                     != std::filesystem::file_type::not_found)
            refuse(path, "cannot be read");
        return {};
    }
    try {
        return parse(path, Json::parse(file));
    } catch (const Json::exception&) {
        refuse(path, "is damaged");
    }
}

}  // namespace assets
