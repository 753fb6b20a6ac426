// What the program can do with a shot: one function per command. Results go to stdout, everything else to stderr.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shots {

/// What the command line asks for.
struct Request {
    std::filesystem::path shot;
    std::vector<std::string> overrides;  // "key.path=value"
    std::optional<std::string> frames;   // "1001-1024x2, 1030"; none: those of the shot
    std::filesystem::path out;           // empty: output.path of the shot
    bool json = false;                   // results as JSON lines
    bool quiet = false;                  // no progress, no warnings
    bool overwrite = false;              // start afresh: discard what is there
};

/// Frame cache and tables of numbers, from the shot's first frame to the largest one asked for.
void sim_command(const Request& request);

/// Pictures of the frames in the cache. Throws Error(Input) where the cache is another version's.
void render_command(const Request& request);

/// sim, render and encode; each does only what is missing.
void film_command(const Request& request);

/// Bodies and their regions: volume, mass, domains, modulus.
void regions_command(const Request& request);

}  // namespace shots
