#!/usr/bin/env bash
# Installs missing packages, builds, and runs every test. Names skipped tests with their reasons.
# test.sh [PRESET...]: release by default; asan and tsan run the same tests under sanitizers.
set -euo pipefail
cd "$(dirname "$0")/.."
./scripts/install_packages.sh --tests
[ $# -gt 0 ] || set -- release
for preset in "$@"; do
    ./scripts/build.sh "$preset"
    results="$PWD/build/$preset/tests.xml"
    printed="$PWD/build/$preset/tests.txt"
    status=0
    # three slots for each processor: tests that compute take two, those that mostly wait one (PROCESSORS in tests/CMakeLists.txt)
    ctest --preset "$preset" --parallel "$((3 * $(nproc)))" --output-junit "$results" | tee "$printed" || status=$?
    ./tests/skipped.py "$results"
    sed -n '/% tests passed/,$p' "$printed" # ctest's summary stands last
    [ "$status" -eq 0 ] || exit "$status"
done
