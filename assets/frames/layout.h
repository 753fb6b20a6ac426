// The names of files of frames.
#pragma once

#include <filesystem>
#include <string>

namespace assets {

inline constexpr const char* manifest_name = "manifest.json";
inline constexpr const char* surfaces_name = "surfaces.bin";
inline constexpr const char* checkpoint_name = "checkpoint.bin";

/// A frame's number as file names carry it: at least four digits, "0007", "-0007", "12345".
std::string padded(int number);

/// "frame.0007.bin".
std::string frame_name(int number);

/// Whether a cache calls one of its files so.
bool is_cache_file(const std::string& name);

/// Removes all files of a cache, the manifest first: without it the others count for nothing.
void remove_cache_files(const std::filesystem::path& folder);

}  // namespace assets
