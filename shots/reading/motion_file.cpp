#include "shots/reading/motion_file.h"

#include "assets/base/error.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <numbers>
#include <optional>
#include <string_view>

namespace shots {

namespace {

constexpr std::size_t least_words = 7, most_words = 8;
constexpr const char* wanted = "frame tx ty tz rx ry rz";
constexpr const char* blanks = " \t\r";

struct Word {
    std::string_view text;
    std::size_t column = 0;  // from 1
};

std::vector<Word> words_of(std::string_view line) {
    line = line.substr(0, line.find('#'));
    std::vector<Word> words;
    for (std::size_t end = 0;;) {
        const std::size_t begin = line.find_first_not_of(blanks, end);
        if (begin == std::string_view::npos)
            return words;
        end = std::min(line.find_first_of(blanks, begin), line.size());
        words.push_back({line.substr(begin, end - begin), begin + 1});
    }
}

std::optional<double> number_of(std::string_view text) {
    if (text.starts_with('+'))
        text.remove_prefix(1);
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number =
        error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
    return is_number ? std::optional(number) : std::nullopt;
}

/// The numbers of a line; empty where something is wrong with it.
std::vector<double> numbers_of(const std::vector<Word>& words,
                               int line,
                               std::vector<std::string>& mistakes) {
    const std::size_t before = mistakes.size();
    std::vector<double> numbers;
    for (const Word& word : words)
        if (const std::optional<double> number = number_of(word.text))
            numbers.push_back(*number);
        else
            mistakes.push_back(
                fmt::format("{}:{}: '{}' is no number", line, word.column, word.text));
    if (words.size() < least_words || words.size() > most_words)
        mistakes.push_back(fmt::format("{}:{}: {} numbers, must be {}: {}",
                                       line,
                                       words.front().column,
                                       words.size(),
                                       least_words,
                                       wanted));
    return mistakes.size() == before ? numbers : std::vector<double>{};
}

/// By whole turns, to within half a turn of the one before.
Vec3 shorter_way(const Vec3& angles, const Vec3& before) {
    constexpr double turn = 2 * std::numbers::pi;
    Vec3 near = angles;
    for (int k = 0; k < 3; ++k)
        near[k] -= turn * std::round((angles[k] - before[k]) / turn);
    return near;
}

}  // namespace

std::vector<sim::ColliderKey> read_motion(const std::filesystem::path& file,
                                          int first_frame,
                                          double fps,
                                          std::vector<std::string>& mistakes) {
    std::ifstream stream(file);
    std::vector<sim::ColliderKey> keys;
    std::string text;
    for (int line = 1; std::getline(stream, text); ++line) {
        const std::vector<Word> words = words_of(text);
        if (words.empty())
            continue;
        const std::vector<double> n = numbers_of(words, line, mistakes);
        if (n.empty())
            continue;
        sim::ColliderKey key;
        key.time = (n[0] - first_frame) / fps;
        key.translate = {n[1], n[2], n[3]};
        key.rotate = Vec3(n[4], n[5], n[6]) * (std::numbers::pi / 180);
        if (!keys.empty()) {
            key.rotate = shorter_way(key.rotate, keys.back().rotate);
            if (!(key.time > keys.back().time))
                mistakes.push_back(
                    fmt::format("{}:{}: frames ascend: {} is not after the one before",
                                line,
                                words[0].column,
                                words[0].text));
        }
        keys.push_back(key);
    }
    if (!stream.eof())
        throw assets::Error(assets::ErrorKind::Input,
                            fmt::format("'{}' cannot be read", file.string()));
    if (keys.empty() && mistakes.empty())
        mistakes.push_back(fmt::format("1:1: no frame, must be lines of {}", wanted));
    return keys;
}

}  // namespace shots
