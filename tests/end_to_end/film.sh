#!/usr/bin/env bash
# A shot becomes a film; a second start does nothing; what changes is done again, and only that.
source "$(dirname "$0")/common.sh" "$1"

expect_exit 0 "$supple" film "$tiny"
[ "$(cat out.txt)" = out/tiny/tiny.mp4 ] || fail "the film's path is not the one result"
for file in tiny.mp4 stats.csv probes.csv pins.csv images/tiny.0001.png images/tiny.0004.png; do
    [ -s "out/tiny/$file" ] || fail "no $file"
done
frames=$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames,codec_name,width,height,pix_fmt,color_space \
    -of default=nw=1 out/tiny/tiny.mp4 | sort | tr '\n' ' ')
[ "$frames" = "codec_name=h264 color_space=bt709 height=54 nb_read_frames=4 pix_fmt=yuv420p width=96 " ] ||
    fail "the film is $frames"
[ "$(wc -l <out/tiny/stats.csv)" -eq 5 ] || fail "stats.csv has not a header and four rows"

# A second start leaves every file as it is, times included.
state() { find out/tiny -type f -printf '%p %T@ %s\n' | sort; }
before=$(state)
expect_exit 0 "$supple" film "$tiny"
[ "$(state)" = "$before" ] || fail "a second start changed files"

# A damaged picture alone is rendered again, with the same bytes.
pictures=$(content out/tiny/images)
cache=$(content out/tiny/cache)
echo broken >out/tiny/images/tiny.0003.png
expect_exit 0 "$supple" film "$tiny"
[ "$(content out/tiny/images)" = "$pictures" ] || fail "the damaged picture is not what it was"

# Another look needs new pictures and a new film, but no new simulation.
expect_exit 0 "$supple" film "$tiny" --set output.samples=2
[ "$(content out/tiny/images)" != "$pictures" ] || fail "other samples gave the same pictures"
[ "$(content out/tiny/cache)" = "$cache" ] || fail "other samples changed the cache"

# Another modulus is refused, unless the old frames may go.
expect_exit 2 "$supple" film "$tiny" --set body.bar.region.soft.young_modulus=50e3
grep -q 'body.bar.region.soft.young_modulus' err.txt || fail "the key that differs is not named"
[ "$(content out/tiny/cache)" = "$cache" ] || fail "a refused film changed the cache"
expect_exit 2 "$supple" render "$tiny" --set body.bar.region.soft.young_modulus=50e3
expect_exit 0 "$supple" film "$tiny" --set body.bar.region.soft.young_modulus=50e3 --overwrite
[ "$(content out/tiny/cache)" != "$cache" ] || fail "another modulus gave the same frames"

# Another colour, simulated again, needs new pictures of the same motion.
recoloured=(--set 'body.bar.region.soft.color=[0, 1, 0]')
expect_exit 0 "$supple" film "$tiny" --out coloured
pictures=$(content coloured/images)
expect_exit 0 "$supple" sim "$tiny" --out coloured --overwrite "${recoloured[@]}"
expect_exit 0 "$supple" render "$tiny" --out coloured "${recoloured[@]}"
[ "$(content coloured/images)" != "$pictures" ] || fail "another colour gave the same pictures"

# Frames at uneven distances would play at a speed of their own.
expect_exit 2 "$supple" film "$tiny" --frames 1,2,4 --out uneven
grep -q 'frames 1, 2, 4' err.txt || fail "the uneven frames are not named"

# One frame makes no film.
expect_exit 0 "$supple" film "$tiny" --frames 1 --out one
[ "$(cat out.txt)" = one/images/tiny.0001.png ] || fail "one frame: $(cat out.txt)"
[ ! -e one/tiny.mp4 ] || fail "one frame made a film"
