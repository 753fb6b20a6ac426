// How far a mistyped word is from the one that was meant.
#pragma once

#include <string_view>

namespace assets {

/// Fewest insertions, deletions, replacements and swaps of neighbours that turn one word into the other.
int edit_distance(std::string_view a, std::string_view b);

}  // namespace assets
