#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"
#include "assets/frames/layout.h"
#include "tests/unit/assets/frames/cache_fixture.h"

#include <catch2/catch.hpp>

using namespace assets;
using namespace tests;
using Catch::Matchers::Contains;

TEST_CASE("frame numbers are padded to four digits, in every file's name") {
    CHECK(padded(7) == "0007");
    CHECK(padded(1001) == "1001");
    CHECK(padded(12345) == "12345");
    CHECK(padded(-7) == "-0007");
    CHECK(frame_name(-7) == "frame.-0007.bin");
    CHECK(is_cache_file(frame_name(-7)));
}

TEST_CASE(
    "a file that another program writes appears once it is kept, and leaves nothing else") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "film.mp4";
    {
        const UnfinishedFile lost(path);
        write_file(lost.temporary(), "half");
        CHECK_FALSE(std::filesystem::exists(path));
    }
    CHECK(contents(folder.path()).empty());
    {
        UnfinishedFile film(path);
        write_file(film.temporary(), "whole");
        film.keep();
    }
    CHECK(contents(folder.path()).size() == 1);
    CHECK(read_whole(path) == "whole");
    UnfinishedFile never(path);
    CHECK_THROWS_WITH(never.keep(), Contains("film.mp4"));
    CHECK(read_whole(path) == "whole");
}

TEST_CASE("what cannot be read is told and never taken for empty") {
    const TemporaryFolder folder;
    write_file(folder.path() / "empty", "");
    CHECK(read_whole(folder.path() / "empty").empty());
    CHECK_THROWS_WITH(read_whole(folder.path() / "none"),
                      Contains("cannot read") && Contains("none"));
    CHECK_THROWS_AS(read_whole(folder.path()), Error);
}
