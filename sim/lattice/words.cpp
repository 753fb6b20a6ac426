#include "assets/base/edit_distance.h"
#include "sim/lattice/selection.h"

#include <algorithm>

namespace sim {

bool matches(const std::string& pattern, const std::string& text) {
    std::size_t p = 0, t = 0;
    std::size_t star = std::string::npos,
                after_star = 0;  // last "*" seen, and the text it has swallowed up to
    while (t < text.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            after_star = t;
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
            ++p;
            ++t;
        } else if (star != std::string::npos) {
            p = star + 1;
            t = ++after_star;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == std::string::npos;
}

std::string nearest_word(const std::string& word, const std::vector<std::string>& choices) {
    const auto nearest = std::min_element(
        choices.begin(), choices.end(), [&](const std::string& a, const std::string& b) {
            return assets::edit_distance(word, a) < assets::edit_distance(word, b);
        });
    return nearest == choices.end() ? std::string() : *nearest;
}

}  // namespace sim
