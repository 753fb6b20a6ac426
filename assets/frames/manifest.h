// manifest.json: what a cache holds and where it comes from. Written last, so that a folder without one holds nothing.
#pragma once

#include "assets/frames/frame_cache.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace assets {

struct Manifest {
    Fingerprint fingerprint;
    std::string digest;                      // of the fingerprint
    std::vector<int> frame_numbers;          // planned, ascending
    std::string surfaces_checksum;           // of the file surfaces.bin
    std::vector<std::string> surface_names;  // "body/skin"
};

void write_manifest(const std::filesystem::path& folder, const Manifest& manifest);

/// Empty where there is none. Throws Error(Input) where it is damaged or of another version.
std::optional<Manifest> read_manifest(const std::filesystem::path& folder);

}  // namespace assets
