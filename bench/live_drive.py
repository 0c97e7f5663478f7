#!/usr/bin/python3
"""Drives paper-stream live, in step with the clock, and receives its output: live_drive.py HERTZLINE [SECONDS [RATE_HZ]]

Prints the fixed latency, how much later than that the frames come, and what was lost. The sender and the listener are this one process: on
a machine with two processors they share them with the stream.
"""
import json, os, sys, time
import numpy as np
import zmq
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../tests/clients"))
from streaming import Stream

FRAME, CUT = 256, 512  # samples: of the stream, and of a message to it

program, seconds, rate_hz = sys.argv[1], *map(float, (sys.argv[2:] + ["10", "10e6"][len(sys.argv) - 2:]))
t = np.arange(int(rate_hz * 1e-3)) / rate_hz
burst = np.where(t < 25 / 73e3, 1.5e-6 * (1 - np.cos(2 * np.pi * 73e3 / 25 * t)) * np.sin(2 * np.pi * 73e3 * t), 0).astype("<f4")
samples = np.tile(burst, 1 + -(-2 * CUT // len(burst)))
with Stream(program, "paper-stream", "--drive", "tcp://127.0.0.1:*", "--duration", str(seconds), "--wait-for-subscriber",
            "--set", f"output.frame_samples={FRAME}", "--set", f"output.sample_rate_hz={rate_hz}") as stream, zmq.Context() as context:
    listener, sender = context.socket(zmq.SUB), context.socket(zmq.PUSH)
    listener.rcvhwm = sender.linger = 0
    listener.connect(stream.endpoint)
    listener.subscribe("v_out/raw")
    listener.subscribe("meta")
    latency = json.loads(listener.recv_multipart()[-1])["latency_samples"]
    sender.connect(stream.said.split("drive ")[1].split()[0])
    cuts = int((seconds * rate_hz + 10 * FRAME) / CUT)
    sent_at, came_at = np.zeros(cuts), np.zeros(int(np.ceil(seconds * rate_hz / FRAME)))
    cut = frame = 0
    time.sleep(0.5)  # the stream begins some tenths of a second after its first subscriber has come
    start = time.perf_counter()
    while frame < len(came_at):
        now = time.perf_counter() - start
        while cut < cuts and now * rate_hz >= (cut + 1) * CUT:  # a message leaves when its last sample is there
            begin = cut * CUT % len(burst)
            sender.send(samples[begin:begin + CUT].tobytes())
            sent_at[cut] = time.perf_counter() - start
            cut += 1
        try:
            while frame < len(came_at):
                topic, *_ = listener.recv_multipart(zmq.NOBLOCK)
                if topic != b"meta":
                    came_at[frame] = time.perf_counter() - start
                    frame += 1
        except zmq.Again:
            time.sleep(20e-6)
        if stream.process.poll() is not None and not listener.poll(200):
            break
    end = json.loads(stream.summary())
# the frame from sample k on needs the samples before k
needs = np.clip((np.arange(frame) * FRAME - 1) // CUT, 0, cuts - 1)
late_us = 1e6 * (came_at[:frame] - sent_at[needs])[np.arange(frame) * FRAME >= CUT]
print(f"fixed latency {latency} samples = {1e6 * latency / rate_hz:.1f} us; of them the frame {1e6 * FRAME / rate_hz:.1f} us")
print(f"frames after the last sample that they need: median {np.median(late_us):.0f} us, 90 % {np.percentile(late_us, 90):.0f} us, "
      f"99 % {np.percentile(late_us, 99):.0f} us, largest {late_us.max():.0f} us")
print(f"{seconds:g} s at {rate_hz:g} samples a second: {frame} of {len(came_at)} frames heard, {end['v_out_raw_dropped']} dropped; of the drive "
      f"{end['drive_lost']} samples lost, {end['drive_refused']} messages refused, {end['drive_underruns']} underruns")
