#!/bin/sh
# soak.sh [SECONDS]: streams for SECONDS (default: 1800) with subscribers that come, go, record, are killed and are slow, while the
# processors are busy. Prints counts of sent and lost frames, memory and file descriptors. Exit status 1 when a demand fails. Needs a
# built program.
set -eu
cd "$(dirname "$0")/.."
exec /usr/bin/python3 scripts/soak.py --program build/release/hertzline --seconds "${1:-1800}"
