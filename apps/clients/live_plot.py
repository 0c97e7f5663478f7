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
plt.figure(layout="constrained").suptitle(f"{stream} from sample {end - len(v)}")
plt.subplot(211, xlabel="time [ms]", ylabel=head["unit"]).plot(np.arange(len(v)) * 1e3 / head["fs"], v)
plt.subplot(212).magnitude_spectrum(v, head["fs"] / 1e3, window=np.ones(len(v)), pad_to=4 * len(v), scale="dB")
plt.gca().set(xlabel="frequency [kHz]", ylabel=f"dB re 1 {head['unit']}", xlim=(0, 700), ylim=(-90, 0))
plt.savefig(png, dpi=120)
