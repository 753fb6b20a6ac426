#include "assets/frames/fingerprint.h"

#include "assets/frames/checksum.h"

#include <cstddef>
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <vector>

namespace assets {
namespace {

std::string shown(const Fingerprint& fingerprint, const std::string& key) {
    constexpr std::size_t longest = 60;
    const auto at = fingerprint.find(key);
    if (at == fingerprint.end())
        return "(absent)";
    return at->second.size() <= longest ? at->second : at->second.substr(0, longest) + "...";
}

}  // namespace

std::string digest(const Fingerprint& fingerprint) {
    std::string all;
    for (const auto& [key, value] : fingerprint) {
        // Lengths first, so that no two fingerprints run together into the same text.
        all += fmt::format("{} {} {}{}", key.size(), value.size(), key, value);
    }
    return hexadecimal(checksum(all));
}

std::string differences(const Fingerprint& found, const Fingerprint& wanted) {
    constexpr std::size_t most = 8;
    Fingerprint all_keys = found;
    all_keys.insert(wanted.begin(), wanted.end());
    std::vector<std::string> lines;
    for (const auto& [key, ignored] : all_keys) {
        const auto old = found.find(key), now = wanted.find(key);
        if (old == found.end() || now == wanted.end() || old->second != now->second)
            lines.push_back(
                fmt::format("{}: {} -> {}", key, shown(found, key), shown(wanted, key)));
    }
    if (lines.size() > most) {
        const std::size_t n_more = lines.size() - most;
        lines.resize(most);
        lines.push_back(fmt::format("and {} more", n_more));
    }
    return fmt::format("{}", fmt::join(lines, ", "));
}

}  // namespace assets
