// Small pieces of the sentences that tell the user about a mesh.
#pragma once

#include <fmt/format.h>
#include <string>

namespace assets {

/// "1 edge", "3 edges", "2 vertices".
inline std::string counted(size_t n, const std::string& one, const std::string& many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

inline std::string counted(size_t n, const std::string& one) {
    return counted(n, one, one + "s");
}

}  // namespace assets
