#!/usr/bin/env bash
# Killed in the middle and started again, the cache ends up with the bytes of an uninterrupted run.
source "$(dirname "$0")/common.sh" "$1"

# sim_until_killed SIGNAL FRAME: starts the simulation in out/killed and ends it once that frame is on disk.
sim_until_killed() {
    local code=0
    "$supple" sim "$tiny" --set frames=1-40 --out killed --quiet >/dev/null 2>err.txt &
    local pid=$!
    for _ in $(seq 2000); do
        if [ -e "killed/cache/frame.$2.bin" ] || ! kill -0 "$pid" 2>/dev/null; then
            break
        fi
        sleep 0.005
    done
    kill "-$1" "$pid" 2>/dev/null || true
    wait "$pid" || code=$?
    echo "$code"
}

"$supple" sim "$tiny" --set frames=1-40 --out whole --quiet >/dev/null
[ "$(sim_until_killed KILL 0005)" -eq 137 ] || fail "was not killed in the middle"
[ "$(sim_until_killed TERM 0015)" -eq 75 ] || fail "an interruption must end with 75"
[ ! -e killed/cache/frame.0040.bin ] || fail "nothing was left to resume"
expect_exit 0 "$supple" sim "$tiny" --set frames=1-40 --out killed --quiet
[ "$(content killed/cache)" = "$(content whole/cache)" ] || fail "the resumed cache differs"
for table in probes pins; do
    cmp "killed/$table.csv" "whole/$table.csv" || fail "$table.csv differs"
done

# A frame that takes long, here a minute, is given up.
"$supple" sim "$tiny" --set frames=1-2 --set solver.dt="1e-8 s" --out long --quiet >/dev/null 2>err.txt &
pid=$!
for _ in $(seq 2000); do
    [ -e long/cache/frame.0001.bin ] && break
    sleep 0.005
done
sleep 0.2
kill -TERM "$pid"
code=0
wait "$pid" || code=$?
[ "$code" -eq 75 ] || fail "an interruption within a frame must end with 75, not $code"
[ ! -e long/cache/frame.0002.bin ] || fail "the frame was not given up"
[ -e long/cache/frame.0001.bin ] || fail "a frame that was done is lost"

# A longer shot goes on where the shorter one ended.
"$supple" sim "$tiny" --set frames=1-10 --out longer --quiet >/dev/null
"$supple" sim "$tiny" --set frames=1-40 --out longer --quiet >/dev/null
[ "$(content longer/cache)" = "$(content whole/cache)" ] || fail "the extended cache differs"
