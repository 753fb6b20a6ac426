// From the dotted keys that later errors carry back to the places of the shot file.
#pragma once

#include "shots/reading/value.h"

#include <map>
#include <string>

namespace shots {

class SourceMap {
  public:
    SourceMap() = default;

    /// Maps every key of the tree. `file` is shown in front of lines.
    SourceMap(std::string file, const Table& root);

    /// The place of `key` as messages begin: "file:line:column" or "--set key=value". Of a key that the file does
    /// not hold, the place of the nearest table around it; the file alone where there is none.
    std::string place(std::string key) const;

    /// A place as messages begin.
    std::string text(const Location& at) const;

    const std::string& file() const { return file_; }

  private:
    void add(const std::string& key, const Value& value);

    std::string file_;
    std::map<std::string, Location> places_;
};

}  // namespace shots
