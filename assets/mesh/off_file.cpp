#include "assets/mesh/off_file.h"

#include "assets/mesh/file_text.h"

#include <fmt/format.h>

namespace assets {
namespace {

namespace fs = std::filesystem;

// The next line that is more than a comment.
std::string_view content_line(std::string_view& content, const fs::path& file) {
    while (!content.empty()) {
        std::string_view line = next_line(content);
        line = trimmed(line.substr(0, line.find('#')));
        if (!line.empty())
            return line;
    }
    throw_damaged(file, "it ends early");
}

double next_number(std::string_view& line, const fs::path& file) {
    const std::string_view word = next_word(line);
    const std::optional<double> value = number(word);
    if (!value)
        throw_damaged(file, fmt::format("there is '{}' in place of a number", printable(word)));
    return *value;
}

int next_index(std::string_view& line, const fs::path& file) {
    return as_index(next_number(line, file));
}

// The line with the counts: the first one, after the word that names the kind of off file if there
// is one.
std::string_view count_line(std::string_view& content, const fs::path& file) {
    std::string_view line = content_line(content, file);
    std::string_view rest = line;
    const std::string_view kind = next_word(rest);
    if (number(kind))
        return line;
    if (kind != "OFF" && kind != "COFF" && kind != "NOFF" && kind != "CNOFF" && kind != "STOFF")
        throw_damaged(
            file, fmt::format("'{}' is no kind of off file that can be read", printable(kind)));
    rest = trimmed(rest);
    return rest.empty() ? content_line(content, file) : rest;
}

}  // namespace

PolygonSoup read_off(const fs::path& file) {
    const std::string text = content_of(file);
    std::string_view content = text;
    std::string_view counts = count_line(content, file);
    const int n_vertices = next_index(counts, file);
    const int n_faces = next_index(counts, file);

    PolygonSoup soup;
    for (int v = 0; v < n_vertices; ++v) {
        std::string_view line = content_line(content, file);
        Vec3& x = soup.positions.emplace_back();
        for (int i = 0; i < 3; ++i)
            x[i] = next_number(line, file);
    }
    for (int f = 0; f < n_faces; ++f) {
        std::string_view line = content_line(content, file);
        const int n_corners = next_index(line, file);
        for (int k = 0; k < n_corners; ++k)
            soup.corners.push_back(next_index(line, file));
        soup.face_ends.push_back(soup.corners.size());
    }
    return soup;
}

}  // namespace assets
