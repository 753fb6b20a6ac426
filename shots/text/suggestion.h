// "Did you mean ...?": the nearest of the words that are allowed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace shots {

/// The allowed word nearest to `word`, upper and lower case alike, or empty where none is near: at most a third of its letters
/// (at least one) may differ, or one is the beginning of the other.
std::string nearest(std::string_view word, const std::vector<std::string>& allowed);

/// "; did you mean 'young_modulus'?", or empty where no word is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& allowed);

/// "a, b, c" for messages.
std::string listed(const std::vector<std::string>& words);

}  // namespace shots
