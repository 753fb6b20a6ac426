// Shot files for tests, written into a folder of their own.
#pragma once

#include "shots/shot_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace shots {

/// A fresh folder that goes away with the test.
struct Folder {
    std::filesystem::path path;

    Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder();

    /// Returns the file's path.
    std::filesystem::path write(const std::string& name, const std::string& text) const;
};

/// A small sound shot; each test changes a piece of it. Line numbers in tests count from its first line.
const std::string& sound_shot();

/// `text` with its one `old_piece` replaced. Fails the test where there is not exactly one.
std::string with(const std::string& text,
                 const std::string& old_piece,
                 const std::string& new_piece);

/// Writes the text as a shot file and reads it.
Shot load_text(const std::string& text, const std::vector<std::string>& overrides = {});

/// The lines of the ShotFileError that reading gives, without the path in front: "3:10: error: ...".
std::vector<std::string> mistakes_of(const std::string& text,
                                     const std::vector<std::string>& overrides = {});

}  // namespace shots
