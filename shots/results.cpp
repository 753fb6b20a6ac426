#include "shots/results.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace shots {

void print_path(const std::string& kind, const std::filesystem::path& path, bool json) {
    if (json)
        fmt::print("{}\n", nlohmann::json{{"kind", kind}, {"path", path.string()}}.dump());
    else
        fmt::print("{}\n", path.string());
}

}  // namespace shots
