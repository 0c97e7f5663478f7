#!/bin/sh
# Installs what is missing, builds, and runs every test. Names those that were skipped, and why.
# test.sh [PRESET...]: release by default; asan and tsan run the same tests under sanitizers.
set -eu
cd "$(dirname "$0")/.."
./scripts/install_packages.sh --tests
[ $# -gt 0 ] || set -- release
for preset in "$@"; do
    ./scripts/build.sh "$preset"
    status=0
    results="$PWD/build/$preset/tests.xml"
    ctest --preset "$preset" --parallel "$(nproc)" --output-junit "$results" || status=$?
    ./tests/skipped.py "$results"
    [ "$status" -eq 0 ] || exit "$status"
done
