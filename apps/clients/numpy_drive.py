#!/usr/bin/python3
"""Drives a chain with a tone and receives its output: numpy_drive.py [DRIVE [ENDPOINT [SAMPLES [FILE]]]]

Beside it runs
    hertzline stream paper-stream --drive tcp://127.0.0.1:5575 --wait-for-subscriber
"""
import sys
import numpy as np
import zmq

RATE_HZ, TONE_HZ, AMPLITUDE_M = 10e6, 73e3, 1e-6
CUT, AHEAD = 1000, 20_000  # samples: of a message, and more than the latency

drive, endpoint, samples, file = sys.argv[1:] + ["tcp://127.0.0.1:5575", "tcp://127.0.0.1:5573", "20000", ""][len(sys.argv) - 1:]
samples = int(samples)
context = zmq.Context()
sender, listener = context.socket(zmq.PUSH), context.socket(zmq.SUB)
sender.linger = 0
sender.connect(drive)
listener.connect(endpoint)
listener.subscribe("v_out/raw")

sent, v = 0, np.empty(0, "<f4")
while len(v) < samples:
    while sent < len(v) + AHEAD:
        t = np.arange(sent, sent + CUT) / RATE_HZ
        sender.send((AMPLITUDE_M * np.sin(2 * np.pi * TONE_HZ * t)).astype("<f4").tobytes())
        sent += CUT
    topic, frame = listener.recv_multipart()
    v = np.append(v, np.frombuffer(frame, "<f4"))
v = v[:samples]
print(f"{len(v)} samples of v_out, peak {np.abs(v).max():.4g} m/s")
if file:
    v.tofile(file)
context.destroy(linger=0)
