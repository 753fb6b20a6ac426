// What is wrong with a shot file: collected in one pass, told in the order of the file.
#pragma once

#include "shots/reading/source_map.h"

#include <string>
#include <vector>

namespace shots {

class Report {
  public:
    /// `message` says what was found, what is allowed, and the nearest remedy.
    void error(const Location& at, const std::string& message);
    void warning(const Location& at, const std::string& message);

    bool has_errors() const;

    /// "place: error: message" and "place: warning: message", sorted by place.
    std::vector<std::string> lines(const SourceMap& sources) const;

  private:
    struct Problem {
        Location at;
        bool is_error = true;
        std::string message;
    };

    std::vector<Problem> problems_;
};

}  // namespace shots
