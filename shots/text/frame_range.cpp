#include "shots/text/frame_range.h"

#include "assets/base/error.h"

#include <charconv>
#include <fmt/format.h>
#include <set>

namespace shots {
namespace {

// Far beyond any shot, small enough to count without overflow.
constexpr int largest_number = 10'000'000;

[[noreturn]] void refuse(std::string_view text, const std::string& reason) {
    throw assets::Error(
        assets::ErrorKind::Input,
        fmt::format(
            "frames '{}': {}; allowed: \"12\", \"1-48\", \"1001-1100x2\"", text, reason));
}

/// Reads an integer at the start of `rest` and drops it from there; false where there is none.
bool take_integer(std::string_view& rest, int& number) {
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    if (error == std::errc::result_out_of_range || number > largest_number
        || number < -largest_number)
        refuse(rest, fmt::format("numbers go from -{0} to {0}", largest_number));
    if (error != std::errc{})
        return false;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return true;
}

bool take(std::string_view& rest, char letter) {
    if (rest.empty() || rest.front() != letter)
        return false;
    rest.remove_prefix(1);
    return true;
}

}  // namespace

std::vector<int> FrameRange::numbers() const {
    std::vector<int> result;
    for (int number = first; number <= last; number += step)
        result.push_back(number);
    return result;
}

FrameRange parse_frame_range(std::string_view text) {
    FrameRange range;
    std::string_view rest = text;
    if (!take_integer(rest, range.first))
        refuse(text, "does not start with a frame number");
    range.last = range.first;
    if (take(rest, '-') && !take_integer(rest, range.last))
        refuse(text, "no frame number after '-'");
    if (take(rest, 'x') && !take_integer(rest, range.step))
        refuse(text, "no number after 'x'");
    if (!rest.empty())
        refuse(text, fmt::format("'{}' is left over", rest));
    if (range.last < range.first)
        refuse(text, fmt::format("ends at {} before it starts at {}", range.last, range.first));
    if (range.step < 1)
        refuse(text, "the step after 'x' must be at least 1");
    return range;
}

std::vector<int> parse_frame_list(std::string_view text) {
    constexpr std::string_view separators = ", ";
    std::set<int> numbers;
    for (std::size_t begin = 0;
         (begin = text.find_first_not_of(separators, begin)) != text.npos;) {
        const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
        for (const int number : parse_frame_range(text.substr(begin, end - begin)).numbers())
            numbers.insert(number);
        begin = end;
    }
    if (numbers.empty())
        refuse(text, "names no frame");
    return {numbers.begin(), numbers.end()};
}

}  // namespace shots
