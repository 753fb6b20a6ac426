#include "shots/text/suggestion.h"

#include "assets/base/edit_distance.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>

namespace shots {
namespace {

std::string lower_case(std::string_view word) {
    std::string result(word);
    for (char& letter : result)
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return result;
}

bool begins_the_other(std::string_view a, std::string_view b) {
    constexpr std::size_t fewest_letters = 3;  // shorter beginnings fit too many words
    const std::size_t shared = std::min(a.size(), b.size());
    return shared >= fewest_letters && a.substr(0, shared) == b.substr(0, shared);
}

}  // namespace

std::string nearest(std::string_view word, const std::vector<std::string>& allowed) {
    const std::string wanted = lower_case(word);
    std::string best;
    int least = std::max(1, static_cast<int>(wanted.size()) / 3) + 1;
    for (const std::string& candidate : allowed) {
        const std::string low = lower_case(candidate);
        int distance = assets::edit_distance(wanted, low);
        if (begins_the_other(wanted, low))
            distance = std::min(distance, 1);
        const bool shares_letters =
            distance < static_cast<int>(std::max(wanted.size(), low.size()));
        if (distance < least && shares_letters) {
            least = distance;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& allowed) {
    const std::string best = nearest(word, allowed);
    return best.empty() ? "" : fmt::format("; did you mean '{}'?", best);
}

std::string listed(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace shots
