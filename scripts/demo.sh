#!/bin/sh
# Installs missing packages, builds, and streams the paper's transducer in real time, with a scope in the browser, until Ctrl-C.
# Arguments go to `hertzline stream`: ./scripts/demo.sh --duration 10
set -eu
cd "$(dirname "$0")/.."
./scripts/install_packages.sh
./scripts/build.sh release hertzline

cat <<'TEXT'

Streaming the six-sphere chain into vitreous carbon, a burst every millisecond, 10 million samples a second.
Open the address after "scope" below in a browser: waveform, spectrum, and a knob for each key of the scene.
Or look at it from another terminal, in this directory:

    build/release/hertzline listen --duration 0.01 -o frame.csv      checks and saves ten milliseconds
    build/release/hertzline set drive.amplitude_m=2e-6               turns a knob
    /usr/bin/python3 apps/clients/live_plot.py                       a picture of waveform and spectrum: live.png

Ctrl-C ends it.

TEXT
exec build/release/hertzline stream paper-stream --control tcp://127.0.0.1:5574 --scope "$@"
