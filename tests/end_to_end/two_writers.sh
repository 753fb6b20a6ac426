#!/usr/bin/env bash
# Two processes never write one cache.
source "$(dirname "$0")/common.sh" "$1"

mkdir -p shared/cache
exec {held}<shared/cache
flock "$held"
expect_exit 1 "$supple" sim "$tiny" --out shared --quiet
grep -q "another process is writing shared/cache" err.txt || fail "no cause in: $(cat err.txt)"
flock --unlock "$held"
expect_exit 0 "$supple" sim "$tiny" --out shared --quiet
