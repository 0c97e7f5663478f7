#!/usr/bin/python3
"""Draws a millisecond of a running hertzline stream, waveform and spectrum: live_plot.py [ENDPOINT [STREAM [PNG]]]"""
import json, sys
import matplotlib.pyplot as plt, numpy as np, zmq

endpoint, stream, png = sys.argv[1:] + ["tcp://127.0.0.1:5573", "v_out", "live.png"][len(sys.argv) - 1:]
socket = zmq.Context().socket(zmq.SUB)
socket.rcvtimeo = 10_000  # ms without a frame: nobody streams there
socket.connect(endpoint)
socket.subscribe(f"{stream}/np")
v, end, fs = np.empty(0), None, np.inf
while len(v) < 1e-3 * fs:
    _, header, data = socket.recv_multipart()
    head, fs = json.loads(header), json.loads(header)["fs"]
    frame = np.frombuffer(data, head["dtype"]).reshape(head["shape"])[:, -1]
    v = np.append(v if head["sample"] == end else [], frame)  # anew after a gap: no seam in the picture
    end = head["sample"] + len(frame)
figure, (wave, spectrum) = plt.subplots(2, figsize=(9, 6), layout="constrained")
wave.plot((end - len(v) + np.arange(len(v))) * 1e3 / fs, v, lw=0.7)
wave.set(xlabel="time [ms]", ylabel=f"{stream} [{head['unit']}]")
spectrum.magnitude_spectrum(v, Fs=fs / 1e3, pad_to=4 * len(v), window=plt.mlab.window_none, scale="dB", lw=0.7)
spectrum.set(xlabel="frequency [kHz]", ylabel="level [dB]", xlim=(0, 700), ylim=(-110, -10))
figure.savefig(png, dpi=120)
