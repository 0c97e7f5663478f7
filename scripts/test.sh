#!/bin/sh
# Installs what is missing, builds, and runs every test.
# test.sh [PRESET...]: release by default; asan and tsan run the same tests under sanitizers.
set -eu
cd "$(dirname "$0")/.."
./scripts/install_packages.sh --tests
[ $# -gt 0 ] || set -- release
for preset in "$@"; do
    ./scripts/build.sh "$preset"
    ctest --preset "$preset" --parallel "$(nproc)"
done
