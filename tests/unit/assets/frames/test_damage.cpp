#include "assets/base/error.h"
#include "assets/frames/checksum.h"
#include "tests/unit/assets/frames/cache_fixture.h"

#include <catch2/catch.hpp>

#include <set>

using namespace assets;
using namespace tests;
using Catch::Matchers::Contains;

namespace {

const std::vector<int> numbers{1, 2, 3};
const std::vector<CachedSurface> surfaces{make_surface("skin", 6), make_varying("skin")};

void write_cache(const std::filesystem::path& folder) {
    FrameCacheWriter writer(folder, fingerprint, numbers, surfaces, false);
    for (const int number : numbers)
        writer.write(make_frame(surfaces, number));
    writer.write_checkpoint(3, make_state(3));
}

std::string flipped(std::string bytes, std::size_t at, int bit) {
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
    return bytes;
}

}  // namespace

TEST_CASE("a checksum notices every flipped bit and every zero more") {
    std::string bytes =
        "some bytes that are neither many nor few: 77, more than two stripes of them";
    std::set<std::uint64_t> seen{checksum(bytes)};
    for (std::size_t i = 0; i < bytes.size(); ++i)
        for (int bit = 0; bit < 8; ++bit)
            seen.insert(checksum(flipped(bytes, i, bit)));
    CHECK(seen.size() == 8 * bytes.size() + 1);

    std::set<std::uint64_t> of_zeros;
    for (std::size_t n = 0; n < 100; ++n)
        of_zeros.insert(checksum(std::string(n, '\0')));
    CHECK(of_zeros.size() == 100);
}

TEST_CASE("a flipped bit anywhere in a frame is noticed by the reader and on resuming") {
    const TemporaryFolder folder;
    write_cache(folder.path());
    const FrameCacheReader reader(folder.path());
    const auto path = folder.path() / "frame.0002.bin";
    const std::string whole = read_file(path);
    int n_unnoticed = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        write_file(path, flipped(whole, i, static_cast<int>(i % 8)));
        CHECK_THROWS_WITH(reader.read(2), Contains("frame.0002.bin"));
        n_unnoticed += cache_extent(folder.path(), fingerprint, numbers).n_whole_frames != 1;
    }
    CHECK(n_unnoticed == 0);
}

TEST_CASE("a frame cut short, lengthened or swapped is noticed") {
    const TemporaryFolder folder;
    write_cache(folder.path());
    const auto path = folder.path() / "frame.0002.bin";
    const std::string whole = read_file(path);
    for (std::size_t length = 0; length < whole.size(); length += 7) {
        write_file(path, whole.substr(0, length));
        CHECK_THROWS_WITH(FrameCacheReader(folder.path()).read(2), Contains("frame.0002.bin"));
        CHECK(cache_extent(folder.path(), fingerprint, numbers).n_whole_frames == 1);
    }
    for (const auto& wrong : {whole + '\0', read_file(folder.path() / "frame.0003.bin")}) {
        write_file(path, wrong);
        CHECK_THROWS_WITH(FrameCacheReader(folder.path()).read(2), Contains("frame.0002.bin"));
        CHECK(cache_extent(folder.path(), fingerprint, numbers).n_whole_frames == 1);
    }

    // Written again, it is whole, and so is what comes after it.
    FrameCacheWriter writer(folder.path(), fingerprint, numbers, surfaces, false);
    CHECK(writer.n_whole_frames() == 1);
    writer.write(make_frame(surfaces, 2));
    CHECK(read_file(path) == whole);
    CHECK(cache_extent(folder.path(), fingerprint, numbers).n_whole_frames == 3);
}

TEST_CASE("a header that is damaged gives no bounds and no checksum") {
    const TemporaryFolder folder;
    write_cache(folder.path());
    const auto path = folder.path() / "frame.0002.bin";
    const std::string whole = read_file(path);
    const FrameCacheReader reader(folder.path());
    for (std::size_t i = 0; i < 88; ++i) {
        write_file(path, flipped(whole, i, 0));
        CHECK_THROWS_AS(reader.bounds(2), Error);
        CHECK_THROWS_AS(reader.checksum(2), Error);
    }
}

TEST_CASE("a damaged checkpoint counts as none") {
    const TemporaryFolder folder;
    write_cache(folder.path());
    const auto checkpoint = [&] {
        return cache_extent(folder.path(), fingerprint, numbers).checkpoint;
    };
    const auto path = folder.path() / "checkpoint.bin";
    const std::string whole = read_file(path);
    REQUIRE(checkpoint());
    for (std::size_t i = 0; i < whole.size(); i += 13) {
        write_file(path, flipped(whole, i, 3));
        CHECK_FALSE(checkpoint());
    }
    write_file(path, read_file(folder.path() / "frame.0003.bin"));
    CHECK_FALSE(checkpoint());
}

TEST_CASE("damaged surfaces are refused by the reader and restored by the writer") {
    const TemporaryFolder folder;
    write_cache(folder.path());
    const auto path = folder.path() / "surfaces.bin";
    const std::string whole = read_file(path);
    write_file(path, flipped(whole, whole.size() / 2, 5));
    CHECK_THROWS_WITH(FrameCacheReader(folder.path()), Contains("surfaces.bin"));
    FrameCacheWriter(folder.path(), fingerprint, numbers, surfaces, false);
    CHECK(read_file(path) == whole);
}

TEST_CASE("a damaged manifest is refused by name, but gives way to --overwrite") {
    const TemporaryFolder folder;
    write_cache(folder.path());
    const auto path = folder.path() / "manifest.json";
    const std::string whole = read_file(path);

    SECTION("cut") {
        write_file(path, whole.substr(0, whole.size() / 2));
    }
    SECTION("changed") {
        const std::size_t at = whole.find("0.001");
        write_file(path, std::string(whole).replace(at, 5, "0.002"));
    }
    SECTION("other JSON") {
        write_file(path, "[1, 2]");
    }
    SECTION("other version") {
        const std::size_t at = whole.find("\"version\": 2");
        write_file(path, std::string(whole).replace(at, 12, "\"version\": 1"));
    }

    const auto before = contents(folder.path());
    CHECK_THROWS_WITH(FrameCacheReader(folder.path()), Contains("manifest.json"));
    CHECK_THROWS_WITH(FrameCacheWriter(folder.path(), fingerprint, numbers, surfaces, false),
                      Contains("manifest.json") && Contains("--overwrite"));
    CHECK(contents(folder.path()) == before);
    FrameCacheWriter(folder.path(), fingerprint, numbers, surfaces, true);
    CHECK(read_file(path) == whole);
}

TEST_CASE("a manifest that is there but cannot be read is no empty folder: frames stay") {
    const TemporaryFolder folder;
    write_cache(folder.path());
    const auto path = folder.path() / "manifest.json";
    std::filesystem::remove(path);
    std::filesystem::create_symlink(path, path);  // a loop, which nobody can open
    CHECK_THROWS_WITH(FrameCacheWriter(folder.path(), fingerprint, numbers, surfaces, false),
                      Contains("manifest.json cannot be read"));
    CHECK_THROWS_WITH(FrameCacheReader(folder.path()),
                      Contains("manifest.json cannot be read"));
    CHECK(std::filesystem::exists(folder.path() / "frame.0001.bin"));
}
