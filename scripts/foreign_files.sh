#!/bin/sh
# foreign_files.sh [COUNT] [SEED]: has the readers of the release build read COUNT (default: 20000) damaged recordings that other programs
# have written: tests/fuzz/foreign_files.py. A file that breaks a claim stays in build/release/foreign_findings.
set -eu
cd "$(dirname "$0")/.."
./scripts/build.sh release hertzline hertzline_python $(sed -n 's/^hertzline_fuzz(\(recording_[a-z0-9_]*\))/fuzz_\1/p' tests/fuzz/CMakeLists.txt)
PYTHONPATH=build/release/python exec /usr/bin/python3 -B tests/fuzz/foreign_files.py build/release "$@"
