#!/usr/bin/python3
"""Checks that a client drives a chain and receives its output: chain_is_driven.py HERTZLINE bind|connect CLIENT...; the stream binds the drive's
endpoint or connects to it. A CLIENT that is a .grc is a flowgraph of GNU Radio."""
import socket, subprocess, sys, tempfile
import numpy as np
from streaming import LONG_ENOUGH_S, Stream

RATE_HZ, SAMPLES = 10e6, 20_000

program, way, *client = sys.argv[1:]
with socket.socket() as free:  # GNU Radio's sinks cannot report a port that they choose, so the test chooses one
    free.bind(("127.0.0.1", 0))
    drive = f"tcp://127.0.0.1:{free.getsockname()[1]}"
with tempfile.TemporaryDirectory() as folder:
    flags, duration_s = [""] * 4, SAMPLES / RATE_HZ
    if client[-1].endswith(".grc"):
        subprocess.run(["grcc", "-o", folder, client[-1]], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=LONG_ENOUGH_S)
        client, flags = [sys.executable, "-u", f"{folder}/gnuradio_drive.py"], ["--drive=", "--endpoint=", "--samples=", "--file="]
        duration_s *= 2  # a Head block ends with the sample after its last one
    with Stream(program, "paper-stream", "--drive", f"{way}:{drive}", "--wait-for-subscriber", "--duration", str(duration_s),
                "--record", f"{folder}/out.sigmf-meta", "--columns", "v_out") as stream:
        words = (drive, stream.endpoint, str(SAMPLES), f"{folder}/heard")
        subprocess.run([*client, *map("".join, zip(flags, words))], check=True, timeout=LONG_ENOUGH_S)
        stream.summary()
    heard, made, sent = (np.fromfile(f"{folder}/{name}", "<f4") for name in ("heard", "out.sigmf-data", "out-drive.sigmf-data"))
    subprocess.run([program, "run", f"{folder}/out.sigmf-meta", "--columns", "v_out", "-o", f"{folder}/again.sigmf-meta"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    again = np.fromfile(f"{folder}/again.sigmf-data", "<f4")
assert len(heard) == SAMPLES, len(heard)
tone = 1e-6 * np.sin(2 * np.pi * 73e3 / RATE_HZ * np.arange(len(sent)))
assert np.abs(sent - tone).max() < 1e-3 * 1e-6, "the drive is not the tone"
assert np.array_equal(heard, made[:SAMPLES]), "the client has heard something else"
assert np.array_equal(made, again), "the run of the recording differs"
assert np.abs(made).max() > 0.01
