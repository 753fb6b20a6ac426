#include "shots/stages/frame_table.h"

#include "assets/frames/atomic_file.h"

#include <charconv>
#include <string_view>
#include <system_error>

namespace shots {
namespace {

std::string read_text(const std::filesystem::path& path) {
    return std::filesystem::exists(path) ? assets::read_whole(path) : std::string();
}

/// The number before the first comma; empty for a header.
std::optional<int> frame_of(std::string_view row) {
    int frame = 0;
    const auto [end, failure] = std::from_chars(row.data(), row.data() + row.size(), frame);
    if (failure != std::errc() || end == row.data() + row.size() || *end != ',')
        return {};
    return frame;
}

/// Takes the next whole line off `rest`, newline included; empty where there is none.
std::string_view take_line(std::string_view& rest) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end == std::string_view::npos ? 0 : end + 1);
    rest.remove_prefix(line.size());
    return line;
}

}  // namespace

bool is_table(const std::filesystem::path& path, const std::string& header) {
    return read_text(path).starts_with(header + "\n");
}

std::optional<int> last_frame_in_table(const std::filesystem::path& path) {
    const std::string text = read_text(path);
    std::string_view rest = text;
    std::optional<int> last;
    for (auto row = take_line(rest); !row.empty(); row = take_line(rest))
        if (const auto frame = frame_of(row))
            last = frame;
    return last;
}

void cut_table(const std::filesystem::path& path, const std::string& header, int last_frame) {
    const std::string name = path.filename().string();
    assets::remove_temporaries(path.parent_path(),
                               [&](const std::string& n) { return n == name; });

    const std::string text = read_text(path);
    std::string_view rest = text;
    std::string kept = header + "\n";
    if (take_line(rest) == kept) {
        auto row = take_line(rest);
        for (auto frame = frame_of(row); frame && *frame <= last_frame; frame = frame_of(row)) {
            kept += row;
            row = take_line(rest);
        }
    }
    if (kept != text)
        assets::write_atomically(path, kept);
}

}  // namespace shots
