#!/bin/sh
# build.sh PRESET [TARGET...]: configures when needed and builds. Quiet unless something fails.
set -eu
cd "$(dirname "$0")/.."
preset=$1
shift
log="build/$preset.log"
mkdir -p build
echo "Building ($preset) ..." >&2
if ! { cmake --preset "$preset" && cmake --build --preset "$preset" ${1:+--target} "$@"; } >"$log" 2>&1; then
    cat "$log" >&2
    exit 1
fi
