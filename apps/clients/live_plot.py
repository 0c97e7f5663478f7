#!/usr/bin/python3
"""Draws a millisecond of a running hertzline stream, waveform and spectrum: live_plot.py [ENDPOINT [STREAM [PNG]]]"""
import json, sys
import matplotlib.pyplot as plt, numpy as np, zmq

endpoint, stream, png = sys.argv[1:] + ["tcp://127.0.0.1:5573", "v_out", "live.png"][len(sys.argv) - 1:]
socket = zmq.Context().socket(zmq.SUB)
socket.connect(endpoint)
socket.subscribe(f"{stream}/np")
v, end, head = np.empty(0), None, {"fs": np.inf}
while len(v) < 1e-3 * head["fs"]:
    _, header, data = socket.recv_multipart()
    head = json.loads(header)
    frame = np.frombuffer(data, head["dtype"]).reshape(head["shape"])[:, -1]
    v, end = np.append(v if head["sample"] == end else [], frame), head["sample"] + len(frame)  # anew after a gap
level = 20 * np.log10(np.abs(np.fft.rfft(v, 4 * len(v))) + 1e-30)
figure, (wave, spectrum) = plt.subplots(2, layout="constrained")
wave.plot(np.arange(len(v)) * 1e3 / head["fs"], v)
wave.set(xlabel=f"time since sample {end - len(v)} [ms]", ylabel=f"{stream} [{head['unit']}]")
spectrum.plot(np.fft.rfftfreq(4 * len(v), 1e3 / head["fs"]), level - level.max())
spectrum.set(xlabel="frequency [kHz]", ylabel="level [dB]", xlim=(0, 700), ylim=(-60, 3))
figure.savefig(png, dpi=120)
