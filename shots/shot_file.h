// Shot files: TOML text becomes a Shot, or all that is wrong with it.
#pragma once

#include "assets/base/error.h"
#include "shots/shot.h"

#include <filesystem>
#include <string>
#include <vector>

namespace shots {

/// What is wrong with a shot file: what() is one line "file:line:column: error: message" per mistake, in the order
/// of the file, warnings among them.
class ShotFileError : public assets::Error {
  public:
    explicit ShotFileError(const std::string& lines) : Error(assets::ErrorKind::Input, lines) {}
};

/// Reads a shot file, with overrides "key.path=value" on top, and checks every word of it. Mesh files are relative to
/// the shot file, the output folder to the working directory. Throws ShotFileError with all mistakes of one pass,
/// and assets::Error(Input) where the file cannot be read.
Shot load_shot(const std::filesystem::path& file,
               const std::vector<std::string>& overrides = {});

}  // namespace shots
