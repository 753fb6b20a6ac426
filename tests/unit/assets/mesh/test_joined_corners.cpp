#include "assets/mesh/joined_corners.h"

#include <catch2/catch.hpp>

using assets::joined_corners;

namespace {

bool always(int, int) {
    return true;
}

}  // namespace

TEST_CASE("Corners are joined across smooth edges, at both ends") {
    // Edge 1-2 between the two triangles; the lowest corner stands for those joined.
    const std::vector<std::array<int, 3>> triangles{{0, 1, 2}, {2, 1, 3}};
    CHECK(joined_corners(triangles, always) == std::vector<int>{0, 1, 2, 2, 1, 5});
    CHECK(joined_corners(triangles, [](int, int) { return false; })
          == std::vector<int>{0, 1, 2, 3, 4, 5});
}

TEST_CASE("A crease that ends in a vertex leaves one corner of it around the other way") {
    // Four triangles around vertex 0, all edges smooth but that of triangles 0 and 3.
    const std::vector<std::array<int, 3>> fan{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    const auto joined = joined_corners(fan, [](int t, int u) { return !(t == 0 && u == 3); });
    for (const int corner : {0, 3, 6, 9})
        CHECK(joined[corner] == 0);
    CHECK(joined[1] != joined[11]);  // vertex 1 on either side of the crease
    CHECK(joined[2] == joined[4]);
}

TEST_CASE("Edges of three triangles, and bare ones, join nothing") {
    const std::vector<std::array<int, 3>> book{{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    CHECK(joined_corners(book, always) == std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8});
    CHECK(joined_corners({}, always).empty());
}
