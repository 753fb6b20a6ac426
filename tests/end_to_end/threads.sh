#!/usr/bin/env bash
# One thread and two give the same bytes: frames, tables, pictures.
source "$(dirname "$0")/common.sh" "$1"

for threads in 1 2; do
    "$supple" film "$tiny" --threads $threads --out "with_$threads" --quiet >/dev/null
done
for folder in cache images; do
    [ "$(content with_1/$folder)" = "$(content with_2/$folder)" ] || fail "$folder differs"
done
cmp with_1/probes.csv with_2/probes.csv
cmp with_1/tiny.mp4 with_2/tiny.mp4
