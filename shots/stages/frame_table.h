// Tables that grow by some rows per frame: CSV files with a header line, the frame's number first in every row.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace shots {

/// Whether `path` holds a table with this header, with or without rows.
bool is_table(const std::filesystem::path& path, const std::string& header);

/// The frame of the last whole row; empty where there is none.
std::optional<int> last_frame_in_table(const std::filesystem::path& path);

/// Makes the table hold the header and, of the rows it has, those of frames up to `last_frame`; creates it where it
/// is missing. All three throw assets::Error(Resources), also where a table that is there cannot be read.
void cut_table(const std::filesystem::path& path, const std::string& header, int last_frame);

}  // namespace shots
