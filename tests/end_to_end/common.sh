# Shared by the end-to-end tests: source it with the program's path as $1.
set -euo pipefail
supple=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tiny=$here/tiny.toml
export SUPPLE_THREADS=2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() {
    echo "FAILED: $*" >&2
    exit 1
}

# expect_exit CODE COMMAND...: runs it with its output in out.txt and err.txt.
expect_exit() {
    local wanted=$1 code=0
    shift
    "$@" >out.txt 2>err.txt || code=$?
    if [ "$code" -ne "$wanted" ]; then
        cat err.txt >&2
        fail "exit code $code instead of $wanted: $*"
    fi
}

# Checksums of every file in a folder.
content() {
    (cd "$1" && find . -type f -print0 | sort -z | xargs -0 sha256sum)
}
