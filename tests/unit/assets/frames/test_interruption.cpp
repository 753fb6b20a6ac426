// What a full disk and a killed process leave behind.
#include "assets/base/error.h"
#include "assets/frames/atomic_file.h"
#include "tests/unit/assets/frames/cache_fixture.h"
#include "tests/unit/assets/frames/killed_process.h"

#include <catch2/catch.hpp>

#include <signal.h>
#include <sys/resource.h>

using namespace assets;
using namespace tests;
using Catch::Matchers::Contains;

namespace {

const std::vector<int> numbers{1, 2, 3};
const std::vector<CachedSurface> surfaces{make_surface("skin", 50)};

/// No file can grow beyond `bytes` while this lives: writes come out short, then fail.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_before_(::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }

    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        ::signal(SIGXFSZ, handler_before_);
    }

  private:
    rlimit before_{};
    sighandler_t handler_before_;
};

/// Goes on after the last checkpoint, which no kill lets get ahead of the frames.
void write_frames(const std::filesystem::path& folder) {
    FrameCacheWriter writer(folder, fingerprint, numbers, surfaces, false);
    const auto checkpoint = cache_extent(folder, fingerprint, numbers).checkpoint;
    REQUIRE((!checkpoint || checkpoint->first <= writer.n_whole_frames()));
    for (int number = checkpoint ? checkpoint->first + 1 : 1; number <= numbers.back();
         ++number) {
        writer.write(make_frame(surfaces, number));
        writer.write_checkpoint(number, make_state(number));
    }
}

}  // namespace

TEST_CASE("a full disk is told with path and reason and costs no earlier frame") {
    const TemporaryFolder folder;
    FrameCacheWriter writer(folder.path(), fingerprint, numbers, surfaces, false);
    writer.write(make_frame(surfaces, 1));
    writer.write_checkpoint(1, make_state(1));
    const auto before = contents(folder.path());
    {
        const FileSizeLimit limit(100);
        CHECK_THROWS_WITH(writer.write(make_frame(surfaces, 2)),
                          Contains("frame.0002.bin") && Contains("File too large"));
        CHECK_THROWS_WITH(writer.write_checkpoint(2, make_state(2)),
                          Contains("checkpoint.bin"));
        try {
            writer.write(make_frame(surfaces, 2));
        } catch (const Error& error) {
            CHECK(error.kind() == ErrorKind::Resources);
        }
    }
    CHECK(contents(folder.path()) == before);
    writer.write(make_frame(surfaces, 2));
    CHECK(writer.n_whole_frames() == 2);
}

TEST_CASE("a device without space and a missing folder are told with path and reason") {
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(append_flushed("/dev/full", "bytes"),
                      Contains("/dev/full") && Contains("No space left on device"));
    CHECK_THROWS_WITH(write_atomically(folder.path() / "no" / "where", "bytes"),
                      Contains("no/where") && Contains("No such file"));
    write_file(folder.path() / "file", "");
    CHECK_THROWS_WITH(
        FrameCacheWriter(folder.path() / "file" / "cache", fingerprint, {1}, surfaces, false),
        Contains("file/cache"));
}

TEST_CASE("a cache killed at any moment and resumed ends up with the same bytes") {
    const TemporaryFolder folder;
    write_frames(folder.path() / "whole");
    const auto whole = contents(folder.path() / "whole");
    REQUIRE(whole.size() == numbers.size() + 3);

    const auto cache = folder.path() / "killed";
    int n_kills = 0, n_different = 0;
    while (killed_at_file_operation([&] { write_frames(cache); }, n_kills)) {
        write_frames(cache);
        n_different += contents(cache) != whole;
        std::filesystem::remove_all(cache);
        ++n_kills;
    }
    CHECK(n_kills > 40);
    CHECK(n_different == 0);
}
