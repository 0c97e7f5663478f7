#!/bin/sh
# soak.sh [SECONDS]: streams for SECONDS (default: 1800) with subscribers that come, go, record, are killed and are slow, while the
# processors are busy; prints what was sent, lost and left behind. Exit status 1 when something did not hold. Needs a built program.
set -eu
cd "$(dirname "$0")/.."
exec /usr/bin/python3 scripts/soak.py --program build/release/hertzline --seconds "${1:-1800}"
