#include "assets/base/error.h"
#include "tests/unit/assets/frames/cache_fixture.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace assets;
using namespace tests;
using Catch::Matchers::Contains;

namespace {

const std::vector<CachedSurface> surfaces{make_surface("outer", 50), make_surface("inner", 7)};

void require_equal(const CachedSurface& a, const CachedSurface& b) {
    CHECK(a.body == b.body);
    CHECK(a.skin == b.skin);
    CHECK(a.triangles == b.triangles);
    CHECK(a.rest_positions == b.rest_positions);
    CHECK(a.region_color == b.region_color);
    CHECK(a.varying == b.varying);
}

void require_equal(const Frame& a, const Frame& b) {
    CHECK(a.number == b.number);
    CHECK(a.time == b.time);
    REQUIRE(a.surfaces.size() == b.surfaces.size());
    for (std::size_t s = 0; s < a.surfaces.size(); ++s) {
        CHECK(a.surfaces[s].positions == b.surfaces[s].positions);
        CHECK(a.surfaces[s].normals == b.surfaces[s].normals);
        CHECK(a.surfaces[s].attributes == b.surfaces[s].attributes);
        CHECK(a.surfaces[s].triangles == b.surfaces[s].triangles);
        CHECK(a.surfaces[s].region_color == b.surfaces[s].region_color);
    }
}

/// A cache of frames 1..n_written of `planned`, without checkpoints.
void write_cache(const std::filesystem::path& folder,
                 const std::vector<int>& planned,
                 int n_written) {
    FrameCacheWriter writer(folder, fingerprint, planned, surfaces, false);
    for (int i = 0; i < n_written; ++i)
        writer.write(make_frame(surfaces, planned[static_cast<std::size_t>(i)]));
}

}  // namespace

TEST_CASE("what is written to a cache is read back bit for bit") {
    const TemporaryFolder folder;
    const auto cache = folder.path() / "not" / "there" / "yet";
    FrameCacheWriter writer(cache, fingerprint, {998, 999, 1000, 10001}, surfaces, false);
    for (const int number : {998, 999, 1000})
        writer.write(make_frame(surfaces, number));
    CHECK(writer.n_whole_frames() == 3);

    const FrameCacheReader reader(cache);
    CHECK(reader.planned_frames() == std::vector<int>{998, 999, 1000, 10001});
    CHECK(reader.frames() == std::vector<int>{998, 999, 1000});
    CHECK(reader.fingerprint_digest() == digest(fingerprint));
    REQUIRE(reader.surfaces().size() == surfaces.size());
    for (std::size_t s = 0; s < surfaces.size(); ++s)
        require_equal(reader.surfaces()[s], surfaces[s]);
    for (const int number : reader.frames())
        require_equal(reader.read(number), make_frame(surfaces, number));
    CHECK(reader.checksum(998) != reader.checksum(999));
    CHECK_THROWS_WITH(reader.read(10001), Contains("frame.10001.bin"));
    CHECK_THROWS_WITH(reader.bounds(10001), Contains("frame.10001.bin"));
}

TEST_CASE("bounds span all surfaces of a frame") {
    const TemporaryFolder folder;
    Frame frame = make_frame(surfaces, 1);
    frame.surfaces[0].positions[13] = {-8, 1, 2};
    frame.surfaces[1].positions[3] = {1, 2, 64};
    frame.surfaces[1].positions[6] = {16, -32, -4};
    frame.surfaces[0].positions[0] = {0, 128, 0};
    FrameCacheWriter(folder.path(), fingerprint, {1}, surfaces, false).write(frame);
    const auto [low, high] = FrameCacheReader(folder.path()).bounds(1);
    CHECK(low == Vec3f(-8, -32, -4));
    CHECK(high == Vec3f(16, 128, 64));
}

TEST_CASE("surfaces without attributes, without vertices, and none at all are kept") {
    const TemporaryFolder folder;
    const std::vector<CachedSurface> bare{make_surface("a", 3), make_surface("b", 0)};
    Frame frame = make_frame(bare, 1);
    frame.surfaces[0].attributes.clear();
    frame.surfaces[1].attributes = {{"stretch", {}}, {"", {}}};
    FrameCacheWriter(folder.path() / "bare", fingerprint, {1}, bare, false).write(frame);
    require_equal(FrameCacheReader(folder.path() / "bare").read(1), frame);

    FrameCacheWriter(folder.path() / "none", fingerprint, {-2, -1}, {}, false)
        .write({-2, 0, {}});
    const FrameCacheReader none(folder.path() / "none");
    require_equal(none.read(-2), {-2, 0, {}});
    CHECK(none.bounds(-2) == std::pair<Vec3f, Vec3f>(Vec3f::Zero(), Vec3f::Zero()));
}

TEST_CASE("a varying surface brings triangles and colours of its own in every frame") {
    const TemporaryFolder folder;
    const std::vector<CachedSurface> mixed{
        make_varying("snow"), surfaces[1], make_varying("b")};
    FrameCacheWriter writer(folder.path(), fingerprint, {1, 2, 3}, mixed, false);
    Frame last = make_frame(mixed, 3);
    last.surfaces[0] = {};  // nothing is left
    writer.write(make_frame(mixed, 1));
    writer.write(make_frame(mixed, 2));
    writer.write(last);

    const FrameCacheReader reader(folder.path());
    for (std::size_t s = 0; s < mixed.size(); ++s)
        require_equal(reader.surfaces()[s], mixed[s]);
    require_equal(reader.read(1), make_frame(mixed, 1));
    require_equal(reader.read(2), make_frame(mixed, 2));
    require_equal(reader.read(3), last);
    CHECK(reader.read(2).surfaces[0].positions.size() == 6);

    const std::string bytes = read_file(folder.path() / "frame.0002.bin");
    writer.write(make_frame(mixed, 2));
    CHECK(read_file(folder.path() / "frame.0002.bin") == bytes);
}

TEST_CASE("bounds follow a varying surface from frame to frame") {
    const TemporaryFolder folder;
    const std::vector<CachedSurface> snow{make_varying("snow")};
    FrameCacheWriter writer(folder.path(), fingerprint, {1, 2}, snow, false);
    for (const int number : {1, 2}) {
        Frame frame = make_frame(snow, number);
        for (Vec3f& x : frame.surfaces[0].positions)
            x = Vec3f(1, 2, 3);
        frame.surfaces[0].positions[0] = Vec3f(-1, 0, static_cast<float>(10 * number));
        writer.write(frame);
    }
    const FrameCacheReader reader(folder.path());
    CHECK(reader.bounds(1) == std::pair<Vec3f, Vec3f>({-1, 0, 3}, {1, 2, 10}));
    CHECK(reader.bounds(2) == std::pair<Vec3f, Vec3f>({-1, 0, 3}, {1, 2, 20}));
}

TEST_CASE("a varying surface that makes no sense is refused") {
    const TemporaryFolder folder;
    const std::vector<CachedSurface> mixed{surfaces[1], make_varying("snow")};
    FrameCacheWriter writer(folder.path(), fingerprint, {1}, mixed, false);
    Frame frame = make_frame(mixed, 1);
    SECTION("no colours") {
        frame.surfaces[1].region_color.clear();
    }
    SECTION("a colour that is not finite") {
        frame.surfaces[1].region_color[2].x() = std::nanf("");
    }
    SECTION("a triangle of vertices that are not there") {
        frame.surfaces[1].triangles[0][1] = 5;
    }
    SECTION("a negative index") {
        frame.surfaces[1].triangles[0][1] = -1;
    }
    SECTION("triangles of a surface that does not vary") {
        frame.surfaces[0].triangles = {{0, 1, 2}};
    }
    SECTION("colours of a surface that does not vary") {
        frame.surfaces[0].region_color.resize(7);
    }
    CHECK_THROWS_AS(writer.write(frame), std::logic_error);
    CHECK_FALSE(std::filesystem::exists(folder.path() / "frame.0001.bin"));
}

TEST_CASE("a frame of a surface that varies is none of a cache of one that does not") {
    const TemporaryFolder folder;
    const std::vector<CachedSurface> fixed{make_surface("skin", 5)},
        varying{make_varying("skin")};
    FrameCacheWriter(folder.path() / "fixed", fingerprint, {1}, fixed, false)
        .write(make_frame(fixed, 1));
    FrameCacheWriter(folder.path() / "varying", fingerprint, {1}, varying, false)
        .write(make_frame(varying, 1));
    const auto first = folder.path() / "fixed" / "frame.0001.bin",
               second = folder.path() / "varying" / "frame.0001.bin";
    const std::string bytes = read_file(first);
    write_file(first, read_file(second));
    write_file(second, bytes);
    for (const char* name : {"fixed", "varying"})
        CHECK_THROWS_WITH(FrameCacheReader(folder.path() / name).read(1),
                          Contains("belongs to another cache"));
}

TEST_CASE("frames larger than one compressed piece are kept") {
    const TemporaryFolder folder;
    const std::vector<CachedSurface> large{make_surface("large", 600'000)};  // 19 MB a frame
    const Frame frame = make_frame(large, 1);
    FrameCacheWriter(folder.path(), fingerprint, {1}, large, false).write(frame);
    require_equal(FrameCacheReader(folder.path()).read(1), frame);
}

TEST_CASE("values that are not finite and lengths that disagree are refused") {
    const TemporaryFolder folder;
    FrameCacheWriter writer(folder.path(), fingerprint, {1, 2}, surfaces, false);
    const auto before = contents(folder.path());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    Frame frame = make_frame(surfaces, 1);
    auto& surface = frame.surfaces[1];

    SECTION("position") {
        surface.positions[6].y() = nan;
    }
    SECTION("normal") {
        surface.normals[0].z() = -infinity;
    }
    SECTION("attribute") {
        surface.attributes["stretch"][3] = infinity;
    }
    SECTION("time") {
        frame.time = nan;
    }
    SECTION("too few positions") {
        surface.positions.pop_back();
    }
    SECTION("too few normals") {
        surface.normals.pop_back();
    }
    SECTION("too few values") {
        surface.attributes["stretch"].pop_back();
    }
    SECTION("too few surfaces") {
        frame.surfaces.pop_back();
    }
    SECTION("not planned") {
        frame.number = 3;
    }
    SECTION("not its turn") {
        frame.number = 2;
    }

    CHECK_THROWS_AS(writer.write(frame), std::logic_error);
    CHECK(contents(folder.path()) == before);
    CHECK(writer.n_whole_frames() == 0);
}

TEST_CASE("surfaces that make no sense are refused before anything is created") {
    const TemporaryFolder folder;
    std::vector<CachedSurface> wrong{make_surface("skin", 5)};
    SECTION("rest position") {
        wrong[0].rest_positions[2].x() = std::nanf("");
    }
    SECTION("triangle") {
        wrong[0].triangles[1][2] = 5;
    }
    SECTION("negative index") {
        wrong[0].triangles[1][2] = -1;
    }
    SECTION("colours") {
        wrong[0].region_color.pop_back();
    }
    SECTION("vertices of a varying surface") {
        wrong[0].varying = true;
    }
    CHECK_THROWS_AS(FrameCacheWriter(folder.path() / "cache", fingerprint, {1}, wrong, false),
                    std::logic_error);
    CHECK_FALSE(std::filesystem::exists(folder.path() / "cache"));
}

TEST_CASE("another fingerprint is refused by naming what differs, and touches nothing") {
    const TemporaryFolder folder;
    write_cache(folder.path(), {1, 2, 3}, 2);
    write_file(folder.path() / ".frame.0003.bin.tmp.77", "left over");
    const auto before = contents(folder.path());
    const Fingerprint other{{"solver.dt", "0.002"}, {"fps", "24"}, {"pin.wall.until", "1"}};

    const std::string message = folder.path().string()
                                + " holds other frames: pin.wall.until: (absent) -> 1, solver.dt: 0.001 -> "
                                  "0.002; start again with --overwrite, or use another --out";
    CHECK_THROWS_WITH(FrameCacheWriter(folder.path(), other, {1, 2, 3}, surfaces, false),
                      message);
    CHECK_THROWS_WITH(cache_extent(folder.path(), other, {1, 2, 3}), message);
    CHECK_THROWS_WITH(FrameCacheWriter(folder.path(), fingerprint, {2, 3}, surfaces, false),
                      Contains("frames: 1-3 -> 2-3"));
    CHECK_THROWS_WITH(
        FrameCacheWriter(folder.path(), fingerprint, {1, 2, 3}, {surfaces[0]}, false),
        Contains("surfaces: "));
    CHECK(contents(folder.path()) == before);

    FrameCacheWriter overwriting(folder.path(), other, {1, 2, 3}, surfaces, true);
    CHECK(overwriting.n_whole_frames() == 0);
    CHECK(FrameCacheReader(folder.path()).frames().empty());
    CHECK(FrameCacheReader(folder.path()).fingerprint_digest() == digest(other));
}

TEST_CASE("files that are not the cache's own stay") {
    const TemporaryFolder folder;
    const std::vector<std::string> foreign{"frame.txt",
                                           "frame..bin",
                                           "frame.0001.bin.bak",
                                           ".notes.tmp.1",
                                           ".frame.0001.bin.tmp.x"};
    for (const auto& name : foreign)
        write_file(folder.path() / name, "mine");
    write_file(folder.path() / "frame.0009.bin", "without a manifest this counts for nothing");
    write_file(folder.path() / ".manifest.json.tmp.123", "left over");
    FrameCacheWriter(folder.path(), fingerprint, {1}, surfaces, true);
    auto files = contents(folder.path());
    for (const auto& name : foreign)
        CHECK(files.erase(name) == 1);
    CHECK(files.size() == 2);  // manifest and surfaces
}

TEST_CASE("a longer list of frames extends a cache, a shorter one leaves it as it is") {
    const TemporaryFolder folder;
    write_cache(folder.path(), {1, 2}, 2);
    CHECK(cache_extent(folder.path(), fingerprint, {1, 2, 3, 4}).n_whole_frames == 2);
    write_cache(folder.path(), {1, 2, 3, 4}, 4);
    CHECK(FrameCacheReader(folder.path()).planned_frames() == std::vector<int>{1, 2, 3, 4});

    const auto before = contents(folder.path());
    FrameCacheWriter shorter(folder.path(), fingerprint, {1, 2, 3}, surfaces, false);
    CHECK(shorter.n_whole_frames() == 3);
    CHECK(contents(folder.path()) == before);
}

TEST_CASE("the last checkpoint comes back with its frame") {
    const TemporaryFolder folder;
    FrameCacheWriter writer(folder.path(), fingerprint, {1, 2}, surfaces, false);
    const auto last = [&] {
        return cache_extent(folder.path(), fingerprint, {1, 2}).checkpoint;
    };
    CHECK_FALSE(last());
    writer.write_checkpoint(1, make_state(1));
    writer.write_checkpoint(2, make_state(2));
    const auto checkpoint = last();
    REQUIRE(checkpoint);
    CHECK(checkpoint->first == 2);
    CHECK(checkpoint->second == make_state(2));

    writer.write_checkpoint(2, {});
    REQUIRE(last());
    CHECK(last()->second.empty());
}

TEST_CASE("a digest tells fingerprints apart") {
    CHECK(digest(fingerprint).size() == 16);
    CHECK(digest({{"a", "b"}}) == digest({{"a", "b"}}));
    CHECK(digest({{"a", "b"}}) != digest({{"ab", ""}}));
    CHECK(digest({{"a", "b"}, {"c", "d"}}) != digest({{"a", "b"}, {"c", "e"}}));
    CHECK(digest({}) != digest({{"", ""}}));
}

TEST_CASE("a folder without a cache is told apart from an empty cache") {
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(FrameCacheReader(folder.path() / "nowhere"), Contains("nowhere"));
    CHECK(cache_extent(folder.path() / "nowhere", fingerprint, {1}).n_whole_frames == 0);
}
