// The boundary of a box as a mesh file.
#pragma once

#include "assets/base/vector_types.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace tests {

/// One of this process, written anew each time; its faces look outward, or inward where it `is_inside_out`.
inline std::filesystem::path box_file(const Vec3& low,
                                      const Vec3& high,
                                      bool is_inside_out = false) {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path()
        / ("supple_test_box_" + std::to_string(getpid()) + ".obj");
    std::ofstream file(path);
    for (int a = 0; a < 8; ++a)
        file << "v " << (a & 1 ? high : low).x() << " " << (a & 2 ? high : low).y() << " "
             << (a & 4 ? high : low).z() << "\n";
    file << (is_inside_out
                 ? "f 2 4 3 1\nf 7 8 6 5\nf 5 6 2 1\nf 4 8 7 3\nf 3 7 5 1\nf 6 8 4 2\n"
                 : "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    return path;
}

}  // namespace tests
