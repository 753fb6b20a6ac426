#include "shots/stages/progress.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <sstream>
#include <thread>

using namespace shots;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

TEST_CASE("rates and durations read well") {
    CHECK(rate_text(0.01) == "100 frames/s");
    CHECK(rate_text(0.3) == "3.33 frames/s");
    CHECK(rate_text(4.25) == "4.25 s/frame");
    CHECK(rate_text(0) == "- frames/s");
    CHECK(duration_text(0) == "0 s");
    CHECK(duration_text(7.2) == "8 s");
    CHECK(duration_text(59.5) == "1 min 00 s");
    CHECK(duration_text(200) == "3 min 20 s");
    CHECK(duration_text(7500) == "2 h 05 min");
}

TEST_CASE("a log gets one line per item") {
    std::ostringstream out;
    Progress progress(ProgressStyle::Lines, out);
    progress.start("sim", 3, 1);
    progress.say("note: repaired");
    progress.advance("frame 1002");
    CHECK_THAT(out.str(), StartsWith("note: repaired\nsim frame 1002 (2/3): 0.0"));
    progress.advance("frame 1003");
    progress.finish();
    CHECK_THAT(out.str(), Contains("\nsim frame 1003 (3/3): ") && EndsWith(", 0 s left\n"));
    CHECK(out.str().find('\r') == std::string::npos);
}

TEST_CASE("a bar rewrites its line and ends it before anything else is said") {
    std::ostringstream out;
    {
        Progress progress(ProgressStyle::Bar, out);
        progress.start("render", 4);
        CHECK(out.str() == "\rrender [........................] 0/4");
        progress.advance("frame 1");
        CHECK_THAT(out.str(), Contains("\rrender [######..................] 1/4  frame 1  "));
        progress.say("note");
        CHECK_THAT(out.str(), EndsWith(" left\nnote\n"));
        progress.advance("frame 2");
        CHECK_THAT(out.str(), Contains("\rrender [############............] 2/4  frame 2  "));
    }
    CHECK_THAT(out.str(), EndsWith(" left\n"));
}

TEST_CASE("a bar shows how far a long item has come, from time to time") {
    std::ostringstream out;
    Progress progress(ProgressStyle::Bar, out);
    progress.start("sim", 4);
    const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(250)); };
    progress.reach(0.3);  // too soon
    CHECK_THAT(out.str(), EndsWith("0/4"));
    wait();
    progress.reach(0.509);
    CHECK_THAT(out.str(), Contains("\rsim [###.....................] 0/4 + 50%  "));
    progress.advance("frame 1");
    CHECK_THAT(out.str(), Contains("\rsim [######..................] 1/4  frame 1  "));
    wait();
    progress.reach(0.25);
    CHECK_THAT(out.str(), Contains("] 1/4 + 25%  frame 1  "));
}

TEST_CASE("a log is not told how far an item has come") {
    std::ostringstream out;
    Progress progress(ProgressStyle::Lines, out);
    progress.start("sim", 4);
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
    progress.reach(0.5);
    CHECK(out.str().empty());
}

TEST_CASE("quiet means nothing at all") {
    std::ostringstream out;
    Progress progress(ProgressStyle::Quiet, out);
    progress.start("sim", 2);
    progress.say("note");
    progress.advance("frame 1");
    progress.finish();
    CHECK(out.str().empty());
    CHECK(progress_style(true) == ProgressStyle::Quiet);
}
