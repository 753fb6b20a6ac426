#!/usr/bin/env bash
# The command line: help, JSON, frames, regions, options in any order.
source "$(dirname "$0")/common.sh" "$1"

expect_exit 0 "$supple" --help
head -1 out.txt | grep -q '^Examples' || fail "help does not start with examples"
expect_exit 2 "$supple"
expect_exit 2 "$supple" sim
expect_exit 2 "$supple" sim "$tiny" --no-such-option
expect_exit 2 "$supple" sim "$tiny" --threads 0
expect_exit 2 "$supple" sim "$tiny" --frames ""
expect_exit 2 "$supple" sim "$tiny" --frames 3-7
grep -q "no frame 5" err.txt || fail "$(cat err.txt)"

# Options may stand before or after the shot; each line of results is JSON.
expect_exit 0 "$supple" sim --json --out here "$tiny" --frames 2 --quiet
cmake -D FILE=out.txt -P "$here/check_json.cmake"
[ ! -s err.txt ] || fail "--quiet talks: $(cat err.txt)"
[ "$(find here/cache -name 'frame.*' | wc -l)" -eq 2 ] || fail "--frames 2 must simulate two frames"

# Rendering takes any frames that are there, and names one that is not.
expect_exit 0 "$supple" render "$tiny" --out here --frames 2
[ "$(cat out.txt)" = here/images/tiny.0002.png ] || fail "$(cat out.txt)"
[ ! -e here/images/tiny.0001.png ] || fail "rendered a frame that nobody asked for"
expect_exit 2 "$supple" render "$tiny" --out here --frames 2-3
grep -q "frame 3 is not in here/cache" err.txt || fail "$(cat err.txt)"

# 12 x 4 x 4 domains of 25 mm; the segment 0.1..0.2 holds a third of them, a layer on each side of both interfaces.
expect_exit 0 "$supple" regions "$tiny" --json
cmake -D FILE=out.txt -P "$here/check_json.cmake"
grep -q '"boundary_domains":64,"domains":192' out.txt || fail "body: $(cat out.txt)"
grep -q '"boundary_domains":32,.*"domains":64,.*"region":"soft"' out.txt || fail "soft: $(cat out.txt)"
expect_exit 0 "$supple" regions "$tiny"
grep -Eq '^  soft +0\.001 +1 +64 +50\.0 % +100 kPa +0\.3 +1000$' out.txt || fail "table: $(cat out.txt)"
