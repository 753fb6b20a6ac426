#include "shots/reading/report.h"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace shots {

void Report::error(const Location& at, const std::string& message) {
    problems_.push_back({at, true, message});
}

void Report::warning(const Location& at, const std::string& message) {
    problems_.push_back({at, false, message});
}

bool Report::has_errors() const {
    return std::any_of(problems_.begin(), problems_.end(), [](const Problem& problem) {
        return problem.is_error;
    });
}

std::vector<std::string> Report::lines(const SourceMap& sources) const {
    std::vector<Problem> sorted = problems_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const Problem& a, const Problem& b) {
        return std::tie(a.at.option, a.at.line, a.at.column)
               < std::tie(b.at.option, b.at.line, b.at.column);
    });

    std::vector<std::string> result;
    for (const Problem& problem : sorted)
        result.push_back(fmt::format("{}: {}: {}",
                                     sources.text(problem.at),
                                     problem.is_error ? "error" : "warning",
                                     problem.message));
    return result;
}

}  // namespace shots
