#include "assets/base/error.h"
#include "shots/stages/child_process.h"

#include <catch2/catch.hpp>

using Catch::Matchers::Contains;
using shots::ChildProcess;

TEST_CASE("a child reads what it is given") {
    // 1 MB is more than a pipe holds.
    ChildProcess child({"sh", "-c", "test $(wc -c) -eq 1000000"}, "");
    child.write(std::string(1'000'000, 'x'));
    CHECK_NOTHROW(child.finish());
}

TEST_CASE("a child that fails is told with its own words") {
    ChildProcess child({"sh", "-c", "echo no space >&2; exit 3"}, "");
    child.write(std::string(1'000'000, 'x'));  // it does not read
    CHECK_THROWS_WITH(child.finish(), Contains("exit code 3") && Contains("no space"));
}

TEST_CASE("a program that is not installed is told with the remedy") {
    CHECK_THROWS_WITH(ChildProcess({"supple-no-such-program"}, "install it"),
                      Contains("is not installed") && Contains("install it"));
}
