#!/usr/bin/env bash
# Bad shot files: the right place, exit code 2, and an existing cache stays as it is.
source "$(dirname "$0")/common.sh" "$1"

"$supple" sim "$tiny" --quiet >/dev/null
before=$(content out/tiny)

# mistake PLACE MESSAGE SED-SCRIPT: changes the shot, and expects "bad.toml:PLACE: error: ...MESSAGE...".
mistake() {
    sed -e "$3" "$tiny" >bad.toml
    cmp -s bad.toml "$tiny" && fail "the script '$3' changes nothing"
    for command in sim film regions; do
        expect_exit 2 "$supple" $command bad.toml --quiet
        if ! grep -q "^bad.toml:$1: error: .*$2" err.txt; then
            cat err.txt >&2
            fail "$command: no 'bad.toml:$1: error: ...$2...'"
        fi
        [ "$(wc -l <err.txt)" -eq 1 ] || fail "$command: more than one line for one mistake: $(cat err.txt)"
        [ ! -s out.txt ] || fail "$command: results in spite of a mistake"
    done
    [ "$(content out/tiny)" = "$before" ] || fail "files changed by a bad shot"
}

mistake 16:1 "missing 'young_modulus'" '/"1 MPa"/d'
mistake 19:17 "is a length, not a pressure" 's/"1 MPa"/"1 mm"/'
mistake 19:1 "did you mean 'young_modulus'" '19s/young_modulus/youngs_modulus/'
mistake 19:17 "greater than 0" 's/"1 MPa"/-1e6/'
mistake 20:17 "less than 0.5" 's/= 0.3$/= 0.5/'
mistake 26:17 "soft" '26s/0\.1/7.1/; 26s/0\.2/7.2/'
mistake 13:15 "no file 'no.obj'" '13s/.*/mesh        = "no.obj"/'
mistake 13:15 "outside the world" '13s/0\.3/3e3/'
mistake 9:10 "not available yet" '9s/enriched/auto/'

# Seen when the bodies are made: the ground stands in the bar, whose lowest side is at -0.05.
{ cat "$tiny"; echo '[[collider]]'; echo 'plane = { point = [0, 0, -0.04], normal = [0, 0, 1] }'; } >bad.toml
expect_exit 2 "$supple" sim bad.toml --quiet
grep -q "^bad.toml:12:1: error: body \"bar\" starts inside collider 1: by 0.01 m" err.txt || fail "$(cat err.txt)"
[ "$(content out/tiny)" = "$before" ] || fail "files changed by a body inside a collider"

expect_exit 2 "$supple" sim "$tiny" --set solver.mehtod=fem
grep -q "^--set solver.mehtod=fem: error: .*did you mean 'method'" err.txt || fail "$(cat err.txt)"
expect_exit 2 "$supple" sim missing.toml
grep -q "missing.toml" err.txt || fail "$(cat err.txt)"
