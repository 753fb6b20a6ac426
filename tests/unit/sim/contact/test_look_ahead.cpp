#include "sim/contact/look_ahead.h"

#include <catch2/catch.hpp>

TEST_CASE(
    "a list is made far ahead where distances change slowly, and little where fast, but never "
    "for one place alone") {
    constexpr double most = 0.9;
    sim::LookAhead look;
    CHECK_FALSE(look.stands(0));  // there is none yet
    for (const double change : {0.01, 5.0}) {
        CAPTURE(change);
        look.count();
        const double ahead = look.renew(change, most);
        CHECK(ahead <= most);
        CHECK((ahead == most) == (change < most / 10));
        // The same place again, but for rounding.
        CHECK(look.stands(sim::LookAhead::rounding));
        CHECK(look.stands(0.99 * ahead));
        CHECK_FALSE(look.stands(ahead));
    }
    // The same change in many uses is slow again.
    for (int use = 0; use < 20; ++use)
        look.count();
    CHECK(look.renew(5, most) == most);
}
