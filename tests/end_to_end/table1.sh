#!/usr/bin/env bash
# The benchmark of the paper's table runs its rows, with as many domains as the paper; how fast is nothing to test.
source "$(dirname "$0")/common.sh" "$1"

expect_exit 0 "$supple" bar --steps explicit --threads 1
grep -q '^figure,shot,method,steps,contact,domains,paper_domains,dt_s,threads,' out.txt || fail "$(head -1 out.txt)"
[ "$(wc -l <out.txt)" -eq 7 ] || fail "not three methods with two kinds of contact"
[ "$(grep -c '^13,bar,"[a-z]*",explicit,[a-z]*,931,931,0.001,1,' out.txt)" -eq 6 ] || fail "$(cat out.txt)"
awk -F, 'NR > 1 && !($NF > 0) { exit 1 }' out.txt || fail "a row is not faster than nothing"

expect_exit 105 "$supple" no_such_shot
grep -q 'no_such_shot' err.txt || fail "the shot that is not in the table is not named"
