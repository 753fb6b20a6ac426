// Lines, words and numbers of the files that are read here.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace assets {

/// All bytes of a file. Throws Error(Input) naming it if it cannot be read.
std::string content_of(const std::filesystem::path& file);

/// ".obj" of "Frog.OBJ": lower case.
std::string extension_of(const std::filesystem::path& file);

/// Cuts the first line off the text and returns it without its end.
std::string_view next_line(std::string_view& text);

/// Cuts off the first word and the blanks and line ends before it; empty at the end of the text.
std::string_view next_word(std::string_view& text);

std::string_view trimmed(std::string_view text);

/// The number that the whole word is, "nan" and "inf" too.
std::optional<double> number(std::string_view word);

/// The whole number as an index; -1 if it is none that fits.
int as_index(double value);

/// The start of the text with what is not plain ASCII replaced, fit for a message.
std::string printable(std::string_view text);

}  // namespace assets
