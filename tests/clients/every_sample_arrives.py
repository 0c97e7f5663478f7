#!/usr/bin/python3
"""Checks that a client receives every sample of `hertzline run`: every_sample_arrives.py HERTZLINE STREAM CLIENT..."""
import subprocess, sys, tempfile
import numpy as np
from streaming import LONG_ENOUGH_S, Stream, samples_of_run

SCENE, RATE_HZ, SAMPLES = "paper-stream", 10e6, 200_000  # twenty bursts; the last frame is a short one

program, name, *client = sys.argv[1:]
with tempfile.TemporaryDirectory() as folder:
    run = samples_of_run(program, folder, SCENE, name, SAMPLES, RATE_HZ)
    with Stream(program, SCENE, "--pace", "flat-out", "--duration", str(SAMPLES / RATE_HZ),
                "--wait-for-subscriber") as stream:
        subprocess.run([*client, stream.endpoint, name, str(SAMPLES), f"{folder}/heard"], check=True,
                       timeout=LONG_ENOUGH_S)
    heard = np.fromfile(f"{folder}/heard", "<f4").reshape(-1, run.shape[1])
assert run.any() and len(run) == SAMPLES
assert len(heard) == SAMPLES, f"{len(heard)} samples of {SAMPLES}"
different = np.flatnonzero((heard != run).any(axis=1))
assert not len(different), f"{len(different)} samples differ, first {different[0]}"
