#!/usr/bin/env bash
# A disk that takes no more (here: a limit to the size of files) ends the run with 4; the same command goes on later.
source "$(dirname "$0")/common.sh" "$1"

"$supple" sim "$tiny" --out whole --quiet >/dev/null
limit=$(($(stat -c %s whole/cache/checkpoint.bin whole/cache/frame.0002.bin | sort -n | tail -1) / 1024 - 1))
code=0
(
    trap '' XFSZ # a write beyond the limit then fails instead of killing
    ulimit -f "$limit"
    "$supple" sim "$tiny" --out short --quiet >/dev/null 2>err.txt
) || code=$?
[ "$code" -eq 4 ] || fail "exit code $code instead of 4"
grep -q "cannot write short/cache/.*; what was written before is intact" err.txt || fail "no cause in: $(cat err.txt)"
[ -e short/cache/frame.0001.bin ] || fail "the frame before is gone"
expect_exit 0 "$supple" sim "$tiny" --out short --quiet
[ "$(content short/cache)" = "$(content whole/cache)" ] || fail "the cache differs from one of a run without trouble"
